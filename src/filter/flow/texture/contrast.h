// SPDX-License-Identifier: Apache-2.0
// The grey values of a texture: from averages to [0, 1].
#pragma once
#include <cstdint>
#include <span>

#include "base/context.h"
#include "base/huge_allocator.h"
#include "base/schema/enum_words.h"

namespace sg::texture {

enum class Contrast { none, stretch, equalise };
constexpr auto enum_words(Contrast) {
  using enum Contrast;
  return std::array{Word{"none", none}, Word{"stretch", stretch}, Word{"equalise", equalise}};
}

/// none: as they are. stretch: linear, so that a hundredth of the values lies at each end (`from_zero`: 0 stays 0, and a twentieth
/// of the others lies at 1). equalise: every grey
/// value equally often. NaN stays. Counts are whole numbers: threads do not matter.
void set_contrast(std::span<float> values, Contrast kind, bool from_zero, const Context& context);

/// What differs from the surroundings: each value minus the mean of its 3 x 3 (x 3) neighbours, plus the value; NaN neighbours do not
/// count.
Plane<float> sharpened(std::span<const float> values, const int32_t n[3], const Context& context);

}  // namespace sg::texture
