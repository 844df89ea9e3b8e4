// SPDX-License-Identifier: Apache-2.0
// The requested part of a lattice, and copying of just its rows: what readers that honour ReadOptions::region share.
#pragma once
#include <array>
#include <functional>

#include "data/mesh.h"
#include "io/io.h"

namespace sg {

/// Points lo, lo+stride, ... (`count` of them along each axis) of a lattice of `dims` points.
struct LatticePart {
  std::array<size_t, 3> dims{1, 1, 1}, lo{0, 0, 0}, count{1, 1, 1}, stride{1, 1, 1};
  bool whole() const { return count == dims; }
  size_t points() const { return count[0] * count[1] * count[2]; }
  /// Whether the slice k of the file is wanted.
  bool has_slice(size_t k) const { return k >= lo[2] && (k - lo[2]) % stride[2] == 0 && (k - lo[2]) / stride[2] < count[2]; }
};

/// Cuts `grid` to the region and says which points of the file remain. Throws Error(usage) for a region that is empty.
LatticePart cut_grid(UniformGrid& grid, const LatticeRegion& region);

/// For formats that need a length along every axis: one without gets 1. (Datasets have such axes only where there is a single layer.)
UniformGrid with_long_axes(const UniformGrid& grid);

/// The wanted points of a block of packed tuples of `tuple` bytes, x fastest; touches their rows only. Parallel.
void copy_part(const std::byte* block, size_t tuple, const LatticePart& part, std::byte* out);

/// The same from something that can only be read in order: read(to, bytes) fills `to`, or passes over the bytes when `to` is null.
void stream_part(const std::function<void(std::byte* to, size_t bytes)>& read, size_t tuple, const LatticePart& part, std::byte* out);

}  // namespace sg
