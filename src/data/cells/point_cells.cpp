// SPDX-License-Identifier: Apache-2.0
#include "data/cells/point_cells.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "base/error.h"
#include "data/cells/cell_reader.h"

namespace sg {

namespace {

// Duplicates count: they stand for the cells beyond the border of a piece.
bool left_out(CellReader& reader, const Dataset& d, size_t cell) {
  if (!reader.hidden(cell)) return false;
  const int bits = d.cell_ghost().empty() ? 0 : int(d.cell_ghost().get(cell));
  if (!(bits & ghost_duplicate) || (bits & (ghost_hidden_cell | ghost_refined_cell))) return true;
  if (d.point_ghost().empty()) return false;
  reader.open(cell);
  const auto ids = reader.ids();
  return std::any_of(ids.begin(), ids.end(), [&](int64_t p) { return int(d.point_ghost().get(size_t(p))) & ghost_hidden_point; });
}

}  // namespace

PointCells::PointCells(const DatasetPtr& dataset) {
  CellReader reader(dataset);
  const size_t n = reader.count();
  if (n >= UINT32_MAX) fail_usage(fmt::format("{} cells are too many to list by point", n), "neighbours of points", "crop the mesh first");
  begin_.assign(dataset->point_count() + 1, 0);
  // Counting, then filling in the order of the cells: each list comes out sorted.
  for (size_t c = 0; c < n; ++c) {
    if (left_out(reader, *dataset, c)) continue;
    reader.open(c);
    for (const int64_t p : reader.ids()) ++begin_[size_t(p) + 1];
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  cells_.resize(begin_.back());
  std::vector<size_t> next(begin_.begin(), begin_.end() - 1);
  for (size_t c = 0; c < n; ++c) {
    if (left_out(reader, *dataset, c)) continue;
    reader.open(c);
    for (const int64_t p : reader.ids()) cells_[next[size_t(p)]++] = uint32_t(c);
  }
}

}  // namespace sg
