// SPDX-License-Identifier: Apache-2.0
// MinMaxOctree: ranges of a lattice's values over ever larger cubes, so that the few cubes where a value can occur are found without a look
// at the others.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "index/minmax_bricks.h"

namespace sg {

/// Level 0 are the cubes of MinMaxBricks; a node of level l+1 joins up to 2x2x2 nodes of level l. The last level is one node. Ranges know
/// no NaN; cubes with only NaN are empty and never found.
struct MinMaxOctree {
  using Range = MinMaxBricks::Range;
  struct Level {
    std::array<size_t, 3> dims{0, 0, 0};
    std::vector<Range> ranges;
    size_t id(size_t i, size_t j, size_t k) const { return i + dims[0] * (j + dims[1] * k); }
  };
  std::vector<Level> levels;

  /// The range of everything.
  Range all() const { return levels.empty() ? Range{HUGE_VALF, -HUGE_VALF} : levels.back().ranges[0]; }
  /// Calls f(i, j, k) for the cubes whose range meets [lo, hi], in the order of a depth-first walk (children x fastest).
  /// O(cubes found * depth). A NaN bound or lo > hi finds none.
  template <class F>
  void meeting(double lo, double hi, F&& f) const {
    if (!levels.empty() && lo <= hi) walk(levels.size() - 1, 0, 0, 0, lo, hi, f);
  }
  /// Those whose range holds `value`: where an isosurface can pass.
  template <class F>
  void containing(double value, F&& f) const {
    meeting(value, value, f);
  }

 private:
  template <class F>
  void walk(size_t level, size_t i, size_t j, size_t k, double lo, double hi, F& f) const {
    const Range r = levels[level].ranges[levels[level].id(i, j, k)];
    if (r.empty() || !(double(r.lo) <= hi && double(r.hi) >= lo)) return;
    if (level == 0) return void(f(i, j, k));
    const auto& d = levels[level - 1].dims;
    for (size_t c = 0; c < 8; ++c) {
      const size_t x = 2 * i + (c & 1), y = 2 * j + (c >> 1 & 1), z = 2 * k + (c >> 2);
      if (x < d[0] && y < d[1] && z < d[2]) walk(level - 1, x, y, z, lo, hi, f);
    }
  }
};

/// Over bricks made before.
MinMaxOctree minmax_octree(MinMaxBricks bricks);
/// Over a packed array of one component, dims[0]*dims[1]*dims[2] samples. Throws an internal Error when the array does not fit the dims.
MinMaxOctree minmax_octree(const Array& values, std::array<size_t, 3> dims);

}  // namespace sg
