// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/contour/amr_leaves.h"

#include <algorithm>

#include "base/error.h"

namespace sg {

namespace {

int64_t floor_div(int64_t a, int64_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

}  // namespace

AmrLeaves::AmrLeaves(const Dataset& dataset) : grid_(*dataset.as<AmrGrid>()) {
  if (!dataset.cell_ghost().empty()) ghost_ = dataset.cell_ghost().view<uint8_t>();
  const size_t n = grid_.levels.size();
  size_.assign(n, {1, 1, 1});
  for (size_t l = n; l-- > 1;)
    for (size_t a = 0; a < 3; ++a) {
      size_[l - 1][a] = size_[l][a] * std::max(1, grid_.levels[l].ratio[a]);
      if (size_[l - 1][a] > (1ll << 40)) fail_usage("the levels of the grid are too far apart", "contour", "leave out the finest levels");
    }
  if (n > 0)
    for (int a = 0; a < 3; ++a) unit_[a] = grid_.levels[0].spacing[a] / double(size_[0][size_t(a)]);
  levels_.resize(n);
  for (size_t l = 0; l < n; ++l) {
    Level& level = levels_[l];
    Place sum{};
    for (const auto& p : grid_.levels[l].patches)
      for (size_t a = 0; a < 3; ++a) sum[a] += int64_t(p.cells()[a]);
    for (size_t a = 0; a < 3; ++a)
      level.block[a] = std::max<int64_t>(4, sum[a] / std::max<int64_t>(1, int64_t(grid_.levels[l].patches.size())));
    for (size_t i = 0; i < grid_.levels[l].patches.size(); ++i) {
      const auto& p = grid_.levels[l].patches[i];
      Place lo, hi;
      for (size_t a = 0; a < 3; ++a) lo[a] = floor_div(p.lo[a], level.block[a]), hi[a] = floor_div(p.hi[a], level.block[a]);
      for (int64_t z = lo[2]; z <= hi[2]; ++z)
        for (int64_t y = lo[1]; y <= hi[1]; ++y)
          for (int64_t x = lo[0]; x <= hi[0]; ++x) level.patches[key(x, y, z)].push_back(uint32_t(i));
    }
  }
}

AmrLeaves::Leaf AmrLeaves::at(const Place& cell) const {
  for (size_t l = levels_.size(); l-- > 0;) {
    const Level& level = levels_[l];
    Place c;
    for (size_t a = 0; a < 3; ++a) c[a] = floor_div(cell[a], size_[l][a]);
    const auto found =
        level.patches.find(key(floor_div(c[0], level.block[0]), floor_div(c[1], level.block[1]), floor_div(c[2], level.block[2])));
    if (found == level.patches.end()) continue;
    for (uint32_t i : found->second) {
      const auto& p = grid_.levels[l].patches[i];
      bool in = true;
      for (size_t a = 0; a < 3; ++a) in = in && c[a] >= p.lo[a] && c[a] <= p.hi[a];
      if (!in) continue;
      const auto n = p.cells();
      const size_t k = size_t(c[0] - p.lo[0]) + n[0] * (size_t(c[1] - p.lo[1]) + n[1] * size_t(c[2] - p.lo[2]));
      if (is_leaf(int64_t(p.cell_offset + k))) return leaf(uint32_t(l), i, k);
    }
  }
  return {};
}

AmrLeaves::Leaf AmrLeaves::leaf(uint32_t level, uint32_t patch, size_t k) const {
  const auto& p = grid_.levels[level].patches[patch];
  const auto n = p.cells();
  const Place at{p.lo[0] + int64_t(k % n[0]), p.lo[1] + int64_t(k / n[0] % n[1]), p.lo[2] + int64_t(k / n[0] / n[1])};
  Leaf r{int64_t(p.cell_offset + k), level, patch, {}};
  for (size_t a = 0; a < 3; ++a) r.lo[a] = at[a] * size_[level][a];
  return r;
}

Vec3 AmrLeaves::center(const Leaf& leaf) const {
  Vec3 c;
  for (int a = 0; a < 3; ++a) c[a] = grid_.origin[a] + unit_[a] * (double(leaf.lo[size_t(a)]) + 0.5 * double(size_[leaf.level][size_t(a)]));
  return c;
}

}  // namespace sg
