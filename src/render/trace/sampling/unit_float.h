// SPDX-License-Identifier: Apache-2.0
// Floats in [0, 1): never 1, whatever rounding does.
#pragma once
#include <cstdint>

namespace sg::trace {

constexpr float largest_below_one = 0x1.fffffep-1f;

/// Of random bits: the upper 24 as a fraction.
constexpr float unit_float(uint32_t bits) { return float(bits >> 8) * 0x1.0p-24f; }

/// Of a number in [0, 1) in double, which may round up to 1.
constexpr float below_one(double u) {
  const float f = float(u);
  return f < 1 ? f : largest_below_one;
}

}  // namespace sg::trace
