// SPDX-License-Identifier: Apache-2.0
// How far a lattice's field bends: bounds from second differences, per fine brick, for steps longer than cells.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "base/huge_allocator.h"
#include "data/array.h"

namespace sg::volume {

/// Per fine brick (FineBricks: 4^3 cells) a bound that holds for it and all bricks around it: along any line the slope of the trilinear
/// field changes by at most `bend` per cell length. It is the sum of the jumps at cell faces (second differences) and of the bend inside
/// cells (mixed differences): with |H| the matrix of their largest absolute values, d^T |H| d <= its largest row sum, for every direction
/// d. Over a length s the field leaves its chord by s^2 bend / 8 on average at most, s^2 bend / 4 anywhere.
///
/// Kept in eight bits, rounded up: quarters of octaves, in parts of `range`.
struct Bends {
  static constexpr int least = -50;          ///< exponent of two of code 0
  static constexpr uint8_t unbounded = 255;  ///< next to missing values
  Plane<uint8_t> codes;                      ///< per fine brick, and three more: any of them can be read as a word
  float range = 1;                           ///< of the values

  static uint8_t coded(float v) {
    if (!(v < 1e30f)) return unbounded;
    const int32_t base = (127 + least) << 23, up = std::bit_cast<int32_t>(v) + (1 << 21) - 1;
    return up <= base ? 0 : uint8_t(std::min((up - base) >> 21, 254));
  }
  static float decoded(uint8_t code) { return std::bit_cast<float>((int32_t(code) << 21) + ((127 + least) << 23)); }
};

/// Of packed samples of a type that floats hold exactly, with `range` their largest less their smallest value. `framed`: beyond the
/// outermost samples the field continues with their values, so that it bends there too.
Bends find_bends(const Array& values, std::array<size_t, 3> dims, float range, bool framed);

}  // namespace sg::volume
