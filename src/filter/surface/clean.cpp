// SPDX-License-Identifier: Apache-2.0
#include "filter/surface/clean.h"

#include <fmt/core.h>

#include <algorithm>
#include <unordered_map>

#include "base/error.h"
#include "data/cells/cell_reader.h"
#include "data/lattice.h"
#include "filter/mesh/merge_points.h"
#include "filter/mesh/select/extract.h"
#include "filter/surface/quality.h"

namespace sg {

namespace {

// Polygons and lines without the same point twice in a row.
CellArray without_repeats(const CellArray& cells, bool ring, size_t& repeats) {
  const CellsView v = cells_view(cells);
  std::vector<int32_t> ids, offsets{0};
  const size_t before = repeats;
  for (size_t c = 0; c < v.count; ++c) {
    const size_t first = ids.size();
    for (size_t k = v.begin(c); k < v.end(c); ++k)
      if (const auto id = int32_t(v.connectivity[k]); ids.size() == first || ids.back() != id) ids.push_back(id);
    while (ring && ids.size() > first + 1 && ids.back() == ids[first]) ids.pop_back();
    repeats += v.size(c) - (ids.size() - first);
    offsets.push_back(int32_t(ids.size()));
  }
  if (repeats == before) return cells;
  return {Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets)), 0};
}

struct Counts {
  size_t degenerate = 0, duplicate = 0, flat = 0;
};

std::vector<int64_t> good_cells(const DatasetPtr& d, const CleanParams& p, Counts& went, Context& ctx) {
  CellReader reader(d);
  std::vector<double> size;
  if (p.flat) {
    const Array a = quality(d, {{CellMeasure::size}}, ctx)->fields().require("size", Association::cell).array;
    size.assign(a.view<double>().data, a.view<double>().data + a.count());
  }
  const double length = d->bounds().diagonal();
  std::unordered_map<uint64_t, std::vector<int64_t>> seen;  // cells by a mix of their sorted points
  std::vector<std::vector<int64_t>> keys(p.duplicates ? reader.count() : 0);
  std::vector<int64_t> kept, ids;
  for (size_t c = 0; c < reader.count(); ++c) {
    if (c % 65536 == 0) ctx.check();
    reader.open(c);
    ids.assign(reader.ids().begin(), reader.ids().end());
    const size_t listed = ids.size();
    std::sort(ids.begin(), ids.end());
    const auto distinct = size_t(std::unique(ids.begin(), ids.end()) - ids.begin());
    if (p.degenerate && (listed == 0 || distinct < std::min<size_t>(size_t(reader.dimension()) + 1, listed))) {
      ++went.degenerate;
      continue;
    }
    if (p.flat && reader.dimension() > 1 && !(std::abs(size[c]) > 1e-14 * std::pow(length, reader.dimension()))) {
      ++went.flat;
      continue;
    }
    if (p.duplicates) {
      ids.push_back(-1 - reader.dimension());
      uint64_t h = 0x9e3779b97f4a7c15u;
      for (int64_t id : ids) h = (h ^ uint64_t(id)) * 0xc2b2ae3d27d4eb4fu, h ^= h >> 29;
      auto& same = seen[h];
      if (std::any_of(same.begin(), same.end(), [&](int64_t other) { return keys[size_t(other)] == ids; })) {
        ++went.duplicate;
        continue;
      }
      same.push_back(int64_t(c));
      keys[c] = ids;
    }
    kept.push_back(int64_t(c));
  }
  return kept;
}

}  // namespace

DatasetPtr clean(const DatasetPtr& in, const CleanParams& p, Context& ctx) {
  if (is_lattice(in->mesh())) return in;
  if (in->as<AmrGrid>()) fail_usage("an AMR grid has nothing to clean", "clean", "convert it first: unstructured, faces or resample");
  DatasetPtr d = p.merge ? merge_points(in, {.tolerance = p.tolerance}, ctx) : in;
  if (d->as<PointCloud>()) return d;
  size_t repeats = 0;
  if (auto* s = d->as<SurfaceMesh>(); s && p.degenerate) {
    SurfaceMesh m = *s;
    m.lines = without_repeats(m.lines, false, repeats);
    m.polygons = without_repeats(m.polygons, true, repeats);
    if (repeats > 0) {
      DatasetParts parts = d->parts();
      parts.mesh = std::move(m);
      d = make_dataset(std::move(parts));
    }
  }
  Counts went;
  const std::vector<int64_t> cells = good_cells(d, p, went, ctx);
  const DatasetPtr r = extract_cells(d, cells, "clean");
  ctx.info(fmt::format("clean: {} points, {} degenerate, {} flat and {} duplicate cells removed", in->point_count() - r->point_count(),
                       went.degenerate, went.flat, went.duplicate));
  return r;
}

}  // namespace sg
