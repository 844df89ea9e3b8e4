// SPDX-License-Identifier: Apache-2.0
#include "index/span/spans.h"

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
Spans make(size_t cells, size_t group, const Context& context, AddCell&& add_cell) {
  Spans s;
  const size_t items = (cells + group - 1) / group;
  s.lo.resize(items), s.hi.resize(items);
  parallel_for(
      items, std::max<size_t>(1, 16384 / group),
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          Bounds b;
          for (size_t c = i * group; c < std::min(cells, (i + 1) * group); ++c) add_cell(c, b);
          s.lo[i] = b.lo <= b.hi ? below(b.lo) : HUGE_VALF;
          s.hi[i] = b.lo <= b.hi ? above(b.hi) : -HUGE_VALF;
        }
      },
      &context);
  return s;
}

}  // namespace

Spans cell_spans(const Dataset& mesh, const Array& samples, size_t group, const Context& context) {
  if (group == 0) fail_internal("cell_spans needs groups of one cell at least");
  return dispatch(samples, [&](auto f) -> Spans {
    auto add = [f](const CellsView& cells, size_t cell, Bounds& b) {
      for (size_t k = cells.begin(cell), e = cells.end(cell); k < e; ++k) b.add(f[size_t(cells.connectivity[k])]);
    };
    if (const auto* m = mesh.as<UnstructuredMesh>()) {
      const CellsView cells = cells_view(m->cells);
      return make(cells.count, group, context, [&](size_t c, Bounds& b) { add(cells, c, b); });
    }
    const auto* m = mesh.as<SurfaceMesh>();
    if (!m) fail_internal("cell_spans takes unstructured and surface meshes");
    const CellsView kinds[4] = {cells_view(m->vertices), cells_view(m->lines), cells_view(m->polygons), cells_view(m->strips)};
    return make(mesh.cell_count(), group, context, [&](size_t c, Bounds& b) {
      size_t kind = 0;
      while (c >= kinds[kind].count) c -= kinds[kind++].count;
      add(kinds[kind], c, b);
    });
  });
}

Spans grouped(const Spans& spans, size_t group) {
  Spans s;
  const size_t n = spans.size(), items = (n + group - 1) / group;
  s.lo.assign(items, HUGE_VALF), s.hi.assign(items, -HUGE_VALF);
  for (size_t i = 0; i < n; ++i) {
    s.lo[i / group] = std::min(s.lo[i / group], spans.lo[i]);
    s.hi[i / group] = std::max(s.hi[i / group], spans.hi[i]);
  }
  return s;
}

}  // namespace sg
