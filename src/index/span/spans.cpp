// SPDX-License-Identifier: Apache-2.0
#include "index/span/spans.h"

#include <algorithm>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"

namespace sg {

namespace {

float below(double v) {
  const float f = float(v);
  return double(f) > v ? std::nextafter(f, -HUGE_VALF) : f;
}
float above(double v) {
  const float f = float(v);
  return double(f) < v ? std::nextafter(f, HUGE_VALF) : f;
}

struct Bounds {
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  template <class T>
  void add(T v) {  // NaN fails both comparisons
    if (double(v) < lo) lo = double(v);
    if (double(v) > hi) hi = double(v);
  }
};

// f(cell, bounds) for each cell of the item.
template <class AddCell>
Spans make(size_t cells, size_t group, const Context& context, double* length_of_cells, AddCell&& add_cell) {
  Spans s;
  std::vector<double> lengths;
  const size_t items = (cells + group - 1) / group;
  s.lo.resize(items), s.hi.resize(items);
  if (length_of_cells) lengths.resize(items);
  parallel_for(
      items, std::max<size_t>(1, 16384 / group),
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          Bounds b;
          for (size_t c = i * group; c < std::min(cells, (i + 1) * group); ++c) {
            Bounds cell;
            add_cell(c, cell);
            b.add(cell.lo), b.add(cell.hi);
            if (length_of_cells && cell.hi > cell.lo && std::isfinite(cell.hi - cell.lo)) lengths[i] += cell.hi - cell.lo;
          }
          s.lo[i] = b.lo <= b.hi ? below(b.lo) : HUGE_VALF;
          s.hi[i] = b.lo <= b.hi ? above(b.hi) : -HUGE_VALF;
        }
      },
      &context);
  if (length_of_cells) *length_of_cells = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  return s;
}

}  // namespace

Spans cell_spans(const Dataset& mesh, const Array& samples, size_t group, const Context& context, double* length_of_cells) {
  if (group == 0) fail_internal("cell_spans needs groups of one cell at least");
  return dispatch(samples, [&](auto f) -> Spans {
    auto add = [f](const CellsView& cells, size_t cell, Bounds& b) {
      for (size_t k = cells.begin(cell), e = cells.end(cell); k < e; ++k) b.add(f[size_t(cells.connectivity[k])]);
    };
    if (const auto* m = mesh.as<UnstructuredMesh>()) {
      const CellsView cells = cells_view(m->cells);
      return make(cells.count, group, context, length_of_cells, [&](size_t c, Bounds& b) { add(cells, c, b); });
    }
    const auto* m = mesh.as<SurfaceMesh>();
    if (!m) fail_internal("cell_spans works on unstructured and surface meshes only");
    const CellsView kinds[4] = {cells_view(m->vertices), cells_view(m->lines), cells_view(m->polygons), cells_view(m->strips)};
    return make(mesh.cell_count(), group, context, length_of_cells, [&](size_t c, Bounds& b) {
      size_t kind = 0;
      while (c >= kinds[kind].count) c -= kinds[kind++].count;
      add(kinds[kind], c, b);
    });
  });
}

}  // namespace sg
