// SPDX-License-Identifier: Apache-2.0
#include "filter/probe/cell_slabs.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"

namespace sg {

GridScan::GridScan(const DatasetPtr& dataset, const LatticeView& grid)
    : from(dataset), map(dataset), simplices(*dataset), slack(locate_slack(*dataset)), origin(grid.origin), dims(grid.dims) {
  for (int a = 0; a < 3; ++a) {
    const bool flat = dims[size_t(a)] <= 1;
    spacing[a] = flat ? 0.0 : grid.step[a][a];
    inverse[a] = flat ? 1.0 : 1 / spacing[a];
  }
}

Box3 GridScan::box(CellReader& reader, size_t cell) const {
  Box3 b;
  bool solid = true;
  const CellType t = simplices.type(cell);
  if (t != CellType::empty) {
    solid = t == CellType::tetra;
    for (int k = 0; k < (solid ? 4 : 3); ++k) b.add(simplices.point(simplices.id(cell, k)));
  } else {
    reader.open(cell);
    b = cell_box(reader);
    solid = reader.dimension() == 3;
  }
  const Vec3 size = b.size();
  const double grow = solid ? 1e-7 * std::max({size.x, size.y, size.z}) : slack;
  const Vec3 g(grow, grow, grow);
  return {to_grid(b.lo - g), to_grid(b.hi + g)};
}

CellSlabs GridScan::slabs(size_t thickness, bool cell_layers, Context& context) const {
  constexpr size_t grain = 16384;
  CellReader model = map.reader();
  const size_t cells = model.count(), layers = cell_layers ? std::max<size_t>(dims[2], 2) - 1 : dims[2];
  if (cells >= size_t(1) << 32) fail_usage("the mesh has 2^32 cells or more", "resample", "take a part of it at a time");
  const bool any_hidden = !from->cell_ghost().empty() || !from->point_ghost().empty();
  CellSlabs s;
  s.thickness = thickness;
  const size_t n = (layers + thickness - 1) / thickness, chunks = (cells + grain - 1) / grain;
  struct Reach {
    uint32_t first, last;  // slabs; first > last: none
  };
  Plane<Reach> reach(cells);
  std::vector<size_t> count(n * chunks);  // slab by slab, chunk by chunk: prefix sums are then places
  parallel_for(
      cells, grain,
      [&](size_t begin, size_t end) {
        CellReader reader = model;
        for (size_t c = begin; c < end; ++c) {
          reach[c] = {1, 0};
          if (any_hidden && reader.hidden(c)) continue;
          const Box3 b = box(reader, c);
          bool meets = true;
          for (int a = 0; a < 2; ++a) {
            ptrdiff_t lo, hi;
            points_in(b.lo[a], b.hi[a], dims[size_t(a)], lo, hi);
            meets = meets && (cell_layers ? b.lo[a] <= double(dims[size_t(a)] - 1) && b.hi[a] >= 0 : lo <= hi);
          }
          if (!meets || !(b.lo.z <= b.hi.z)) continue;
          ptrdiff_t lo, hi;
          if (cell_layers) {
            if (b.hi.z < 0 || b.lo.z > double(layers)) continue;
            lo = ptrdiff_t(std::max(std::floor(b.lo.z), 0.0)), hi = ptrdiff_t(std::min(std::floor(b.hi.z), double(layers - 1)));
            lo = std::min(lo, hi);
          } else {
            points_in(b.lo.z, b.hi.z, dims[2], lo, hi);
            if (lo > hi) continue;
          }
          reach[c] = {uint32_t(size_t(lo) / thickness), uint32_t(size_t(hi) / thickness)};
          for (uint32_t k = reach[c].first; k <= reach[c].last; ++k) ++count[k * chunks + begin / grain];
        }
      },
      &context);
  const size_t total = exclusive_scan(count);
  s.begin.resize(n + 1);
  for (size_t k = 0; k < n; ++k) s.begin[k] = chunks ? count[k * chunks] : 0;
  s.begin[n] = total;
  s.cells.resize(total);
  parallel_for(cells, grain, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c)
      for (uint32_t k = reach[c].first; k <= reach[c].last; ++k) s.cells[count[k * chunks + begin / grain]++] = uint32_t(c);
  });
  return s;
}

}  // namespace sg
