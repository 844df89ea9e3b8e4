// SPDX-License-Identifier: Apache-2.0
// Insides: the clear bodies that a path is in. Where bodies with priorities overlap, the one of the highest is there, and the surfaces of
// the others within it are none: Schmidt, Budge, Simple nested dielectrics in ray traced images, Journal of Graphics Tools 7(2), 2002.
#pragma once
#include <array>
#include <cstdint>

#include "render/trace/material/material.h"

namespace sg::trace {

/// Matter behind a surface that rays go on in.
struct ClearBody {
  const Material* material = nullptr;
  uint32_t object = 0;  ///< of the geometry

  int priority() const { return material->priority(); }
};

class Insides {
 public:
  bool none() const { return count_ == 0; }
  /// Bodies beyond the fourth are not noted.
  void enter(ClearBody body) {
    if (count_ < bodies_.size()) bodies_[count_++] = body;
  }
  /// The last of them that was entered. A body that the path began in is not known.
  void leave(const ClearBody& body) {
    for (uint32_t i = count_; i-- > 0;)
      if (bodies_[i].object == body.object) {
        for (--count_; i < count_; ++i) bodies_[i] = bodies_[i + 1];
        return;
      }
  }
  /// Of what is there: the last that was entered, unless it lies within one of a higher priority.
  Vec3f absorption() const {
    if (none()) return {};
    const ClearBody* there = &bodies_[count_ - 1];
    for (uint32_t i = count_ - 1; i-- > 0;)
      if (there->priority() > 0 && bodies_[i].priority() > there->priority()) there = &bodies_[i];
    return there->material->absorption();
  }
  /// Whether the surface of `body` is within another of a higher priority.
  bool hides(const ClearBody& body) const {
    for (uint32_t i = 0; i < count_; ++i)
      if (body.priority() > 0 && bodies_[i].object != body.object && bodies_[i].priority() > body.priority()) return true;
    return false;
  }
  /// What `body` is in, by priority, then by who was entered last; null: air, which is around all bodies without a priority.
  const Material* around(const ClearBody& body) const {
    const ClearBody* found = nullptr;
    for (uint32_t i = 0; i < count_; ++i) {
      const ClearBody& b = bodies_[i];
      if (body.priority() > 0 && b.object != body.object && b.priority() > 0 && (!found || b.priority() >= found->priority())) found = &b;
    }
    return found ? found->material : nullptr;
  }

 private:
  std::array<ClearBody, 4> bodies_;
  uint32_t count_ = 0;
};

}  // namespace sg::trace
