// SPDX-License-Identifier: Apache-2.0
// A ray and where it meets something.
#pragma once
#include <cstdint>
#include <limits>

#include "base/vec.h"

namespace sg::trace {

/// The points origin + t direction, 0 < t <= t_max, in traced coordinates (placement.h). The direction is of unit length.
struct Ray {
  Vec3f origin, direction;
  float t_max = std::numeric_limits<float>::infinity();
};

/// Whether the ray leads anywhere: its numbers are finite, and the direction is not zero.
inline bool can_trace(const Ray& r) {
  const float sum = (r.origin.x + r.origin.y + r.origin.z) * 0 + (r.direction.x + r.direction.y + r.direction.z) * 0;
  return sum == 0 && !(r.direction == Vec3f());
}

/// The nearest of several at the same t is that of the lowest object, then of the lowest primitive.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  uint32_t object = 0;     ///< number in PreparedScene::items
  uint32_t primitive = 0;  ///< number in the object
  float u = 0, v = 0;      ///< triangles: the weights of the second and third corner; tubes: u = place along the segment, 0 to 1
};

struct Box3f {
  Vec3f lo{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity()};
  Vec3f hi{-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};

  bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
  friend bool operator==(const Box3f&, const Box3f&) = default;
};

}  // namespace sg::trace
