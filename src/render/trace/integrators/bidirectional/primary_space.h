// SPDX-License-Identifier: Apache-2.0
// A point of the space of all random numbers that a path is made of, and steps from it (Kelemen et al. 2002).
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "base/random.h"
#include "render/trace/integrators/bidirectional/numbers.h"

namespace sg::trace {

/// Numbers are made when they are asked for, and steps of which nobody asked are made up for: a path may have any number of them. All are
/// counter-based: those of a first point depend on its key alone, so that any chain may start from it.
class PrimarySpace : public Numbers {
 public:
  /// The parts of a path, each with its own numbers, so that one that grows leaves the others as they are.
  enum class Part { way, camera, light, between };

  /// `first`: of the first point; `chain`: of the steps.
  PrimarySpace(uint64_t first, uint64_t chain) : first_(first), chain_(chain) {}

  /// Proposes a step: to a point that does not depend on the present one, or to one near it. Then accept() or reject().
  void propose(bool large);
  void accept();
  void reject();

  /// From here on numbers of this part are asked for, from its first one on.
  void begin(Part part);
  float next() override { return value(part_, at_++); }
  Vec2f next2() override {
    const float x = next();
    return {x, next()};
  }
  /// The same for as long as its number is: that moves by small steps, of which every one makes another stream.
  uint64_t stream() override { return random_bits(first_, std::bit_cast<uint32_t>(next())); }

 private:
  struct Number {
    float value = 0, before = 0;
    uint32_t step = 0, step_before = 0;  // that it is of
    bool made = false;
  };
  float value(size_t part, size_t index);
  float fresh(uint32_t draw, size_t part, size_t index) const;

  uint64_t first_, chain_;
  uint32_t step_ = 0, large_step_ = 0;  // those taken: the last one, the last large one
  uint32_t draw_ = 0, large_draw_ = 0;  // the proposals that they were, which have the random numbers
  uint32_t asked_ = 0;                  // the step of which numbers are asked for
  bool large_ = false;                  // it is one
  size_t part_ = 0, at_ = 0;
  std::array<std::vector<Number>, 4> numbers_;
};

}  // namespace sg::trace
