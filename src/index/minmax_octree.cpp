// SPDX-License-Identifier: Apache-2.0
#include "index/minmax_octree.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace sg {

MinMaxOctree minmax_octree(MinMaxBricks bricks) {
  MinMaxOctree tree;
  if (bricks.ranges.empty()) return tree;
  tree.levels.push_back({bricks.dims, std::move(bricks.ranges)});
  while (tree.levels.back().ranges.size() > 1) {
    const MinMaxOctree::Level& below = tree.levels.back();
    MinMaxOctree::Level up;
    for (size_t a = 0; a < 3; ++a) up.dims[a] = (below.dims[a] + 1) / 2;
    up.ranges.assign(up.dims[0] * up.dims[1] * up.dims[2], {HUGE_VALF, -HUGE_VALF});
    parallel_for(up.dims[1] * up.dims[2], 64, [&](size_t begin, size_t end) {
      for (size_t row = begin; row < end; ++row)
        for (size_t i = 0; i < up.dims[0]; ++i) {
          const size_t j = row % up.dims[1], k = row / up.dims[1];
          MinMaxOctree::Range& to = up.ranges[up.id(i, j, k)];
          for (size_t c = 0; c < 8; ++c) {
            const size_t x = 2 * i + (c & 1), y = 2 * j + (c >> 1 & 1), z = 2 * k + (c >> 2);
            if (x >= below.dims[0] || y >= below.dims[1] || z >= below.dims[2]) continue;
            const MinMaxOctree::Range r = below.ranges[below.id(x, y, z)];
            if (!r.empty()) to = {std::min(to.lo, r.lo), std::max(to.hi, r.hi)};
          }
        }
    });
    tree.levels.push_back(std::move(up));
  }
  return tree;
}

MinMaxOctree minmax_octree(const Array& values, std::array<size_t, 3> dims) { return minmax_octree(minmax_bricks(values, dims)); }

}  // namespace sg
