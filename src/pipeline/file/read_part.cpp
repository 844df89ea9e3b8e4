// SPDX-License-Identifier: Apache-2.0
#include "pipeline/file/read_part.h"

#include "data/lattice.h"
#include "filter/mesh/select/extract.h"
#include "filter/mesh/select/piece.h"

namespace sg {

namespace {

// First and last of n ascending or descending coordinates around [lo, hi], one point to spare on both sides.
template <class F>
void bracket(size_t n, F&& at, double lo, double hi, size_t& first, size_t& last) {
  const bool up = n < 2 || at(n - 1) >= at(0);
  size_t a = 0, b = n - 1;
  while (a < b && (up ? at(a + 1) < lo : at(a + 1) > hi)) ++a;
  while (b > a && (up ? at(b - 1) > hi : at(b - 1) < lo)) --b;
  first = a, last = b;
}

bool has_points(const Data& data) {
  bool any = std::holds_alternative<TablePtr>(data);
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { any = any || d->point_count() > 0; });
  return any;
}

}  // namespace

std::optional<LatticeRegion> lattice_region(const Mesh& mesh, const Box3& box) {
  LatticeRegion r;
  if (auto* u = std::get_if<UniformGrid>(&mesh)) {
    if (!(u->direction == Mat3{})) return std::nullopt;
    for (int a = 0; a < 3; ++a)
      bracket(
          u->dims[size_t(a)], [&](size_t i) { return u->origin[a] + u->spacing[a] * double(i); }, box.lo[a], box.hi[a], r.lo[size_t(a)],
          r.hi[size_t(a)]);
    return r;
  }
  if (auto* g = std::get_if<RectilinearGrid>(&mesh)) {
    const Array* axes[3] = {&g->x, &g->y, &g->z};
    for (int a = 0; a < 3; ++a)
      bracket(
          axes[a]->count(), [&](size_t i) { return axes[a]->get(i); }, box.lo[a], box.hi[a], r.lo[size_t(a)], r.hi[size_t(a)]);
    return r;
  }
  return std::nullopt;
}

Data read_part(const std::string& path, ReadOptions options, const Request& request, Context& context) {
  const Format& format = find_format(path, options);
  if (request.region && options.region.whole() && (format.honours & honours_region)) {
    ReadOptions look = options;
    look.header_only = true;
    const Data header = read_data(path, look, context);
    if (auto* d = std::get_if<DatasetPtr>(&header))
      if (const auto region = lattice_region((*d)->mesh(), *request.region)) options.region = *region;
  }
  // A reader takes whole pieces of a file, with no more ghosts than stand there.
  const bool enough = options.ghost_levels == 0 || request.ghost_levels == 0;
  const bool shared = request.pieces > 1;
  ReadOptions whole = options;
  whole.piece = 0, whole.pieces = 1, whole.ghost_levels = 0;
  if (options.pieces == 1 || (enough && (format.honours & honours_pieces))) {
    const Data data = read_data(path, options, context);
    if (!shared || has_points(data)) return data;
    // Nothing is left for this one, but it goes the same way as the others.
    return map_datasets(read_data(path, whole, context), [](const DatasetPtr& d) { return extract_cells(d, {}, "piece"); });
  }
  return map_datasets(read_data(path, whole, context), [&](const DatasetPtr& d) {
    return (shared ? take_share : take_piece)(d, options.piece, options.pieces, options.ghost_levels, context);
  });
}

}  // namespace sg
