// SPDX-License-Identifier: Apache-2.0
// MinMaxBricks: the range of the values in each little cube of a lattice, so that empty or lower regions are passed over at once.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "data/array.h"

namespace sg {

/// Cube (i,j,k) covers the cells [8i, 8i+8) x ... of a lattice of samples: the samples 8i .. 8i+8, both ends included, so that
/// every value interpolated in one of its cells lies in its range. Cubes are numbered x fastest.
///
///   samples  0 1 2 3 4 5 6 7 8 9 ...
///   cube 0   o-o-o-o-o-o-o-o-o           sample 8 is shared
///   cube 1                   o-o- ...
struct MinMaxBricks {
  static constexpr int shift = 3, edge = 1 << shift;  ///< cells per axis
  struct Range {
    float lo, hi;  ///< of the values that are not NaN, rounded outward; lo > hi when there are none
    bool empty() const { return !(lo <= hi); }
  };
  std::array<size_t, 3> dims{0, 0, 0};  ///< cubes per axis
  std::vector<Range> ranges;

  size_t id(size_t i, size_t j, size_t k) const { return i + dims[0] * (j + dims[1] * k); }
  size_t size() const { return ranges.size(); }
};

/// Ranges of a packed array of one component, dims[0]*dims[1]*dims[2] samples. One parallel pass over the data.
/// Throws an internal Error when the array does not fit the dims.
MinMaxBricks minmax_bricks(const Array& values, std::array<size_t, 3> dims);

/// For each cube, the Chebyshev distance in cubes to the nearest one that is not `empty` (nonzero = empty): 0 for those
/// themselves; d > 0 says that all cubes nearer than d are empty. Beyond the border counts as empty; at most 255.
std::vector<uint8_t> empty_distance(const std::vector<uint8_t>& empty, std::array<size_t, 3> dims);

}  // namespace sg
