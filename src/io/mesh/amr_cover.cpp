// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/amr_cover.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/parallel.h"
#include "data/dataset.h"

namespace sg {

namespace {

long long floor_division(long long a, long long b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

// Marks the cells of `patch` (which begin at `out`) that the box lo..hi touches.
void mark(const AmrGrid::Patch& patch, const std::array<long long, 3>& lo, const std::array<long long, 3>& hi, uint8_t* out) {
  const auto n = patch.cells();
  std::array<size_t, 3> begin{}, end{};
  for (size_t a = 0; a < 3; ++a) {
    const long long from = std::max(lo[a], patch.lo[a]), to = std::min(hi[a], patch.hi[a]);
    if (from > to) return;
    begin[a] = size_t(from - patch.lo[a]), end[a] = size_t(to - patch.lo[a]) + 1;
  }
  for (size_t k = begin[2]; k < end[2]; ++k)
    for (size_t j = begin[1]; j < end[1]; ++j) std::memset(out + begin[0] + n[0] * (j + n[1] * k), ghost_refined_cell, end[0] - begin[0]);
}

}  // namespace

Array refined_cells(const AmrGrid& grid) {
  uint8_t* bits = nullptr;
  Array array = Array::make<uint8_t>(cell_count(grid), 1, &bits);
  if (array.count() > 0) std::memset(bits, 0, array.count());
  for (size_t l = 0; l + 1 < grid.levels.size(); ++l) {
    const auto& fine = grid.levels[l + 1];
    const auto& patches = grid.levels[l].patches;
    parallel_for(patches.size(), 4, [&](size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p)
        for (const auto& f : fine.patches) {
          std::array<long long, 3> lo{}, hi{};
          for (size_t a = 0; a < 3; ++a) {
            const long long r = std::max(fine.ratio[a], 1);
            lo[a] = floor_division(f.lo[a], r), hi[a] = floor_division(f.hi[a], r);
          }
          mark(patches[p], lo, hi, bits + patches[p].cell_offset);
        }
    });
  }
  return array;
}

size_t number_patches(AmrGrid& grid) {
  uint64_t cells = 0, points = 0;
  for (size_t l = 0; l < grid.levels.size(); ++l)
    for (auto& p : grid.levels[l].patches) {
      uint64_t n = 1, m = 1;
      for (size_t a = 0; a < 3; ++a) {
        if (p.hi[a] < p.lo[a] || std::abs(p.lo[a]) > (1ll << 40) || std::abs(p.hi[a]) > (1ll << 40))
          fail_data(fmt::format("a patch of level {} extends from {} to {} along {}", l, p.lo[a], p.hi[a], "xyz"[a]));
        const auto c = uint64_t(p.hi[a] - p.lo[a] + 1);
        if (!multiply(n, c, n) || !multiply(m, grid.dimension == 2 && a == 2 ? 1 : c + 1, m) || m > (uint64_t(1) << 60))
          fail_data(fmt::format("a patch of level {} has too many cells to count", l));
      }
      p.cell_offset = cells, p.point_offset = points;
      if (!add(cells, n, cells) || !add(points, m, points) || points > (uint64_t(1) << 62))
        fail_data("the grid has too many cells to count");
    }
  return cells;
}

}  // namespace sg
