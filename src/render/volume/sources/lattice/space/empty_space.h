// SPDX-License-Identifier: Apache-2.0
// Little bricks of 4^3 cells: which draw something, and how far it is to them. The ranges stay with the data; the distances are recomputed
// whenever a transfer function changes, so that must be fast.
#pragma once
#include "base/huge_allocator.h"
#include "index/minmax_bricks.h"
#include "render/volume/medium/transfer.h"

namespace sg::volume {

/// As MinMaxBricks, with cubes of 4 cells per axis: cube i covers the samples 4i .. 4i+4.
struct FineBricks {
  static constexpr int shift = 2, edge = 1 << shift;
  std::array<size_t, 3> dims{0, 0, 0};
  std::vector<MinMaxBricks::Range> ranges;

  size_t id(size_t i, size_t j, size_t k) const { return i + dims[0] * (j + dims[1] * k); }
  size_t size() const { return ranges.size(); }
};

/// One parallel pass over packed samples of a type that floats hold exactly (u8, i8, u16, i16, f32).
FineBricks fine_bricks(const Array& values, std::array<size_t, 3> dims);
/// The same as minmax_bricks() of the samples, without reading them again.
MinMaxBricks coarse_bricks(const FineBricks& fine);

/// One byte per fine brick; the block is reused for the next transfer function.
using Distances = Plane<uint8_t>;

/// The longest distance in bricks that is told.
constexpr uint8_t farthest_told = 15;

/// For each fine brick the Chebyshev distance in bricks to the nearest one that may draw something: 0 for those themselves; d > 0 says
/// that all bricks nearer than d are empty. At most farthest_told. Three bytes follow the last one, so that each can be read as a word.
Distances distance_to_drawn(const FineBricks& bricks, const Transfer& transfer, bool& any_empty);

}  // namespace sg::volume
