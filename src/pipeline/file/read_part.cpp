// SPDX-License-Identifier: Apache-2.0
#include "pipeline/file/read_part.h"

#include "data/lattice.h"
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
  Data data = read_data(path, options, context);
  if (options.pieces == 1 || (format.honours & honours_pieces)) return data;
  return map_datasets(data,
                      [&](const DatasetPtr& d) { return take_piece(d, options.piece, options.pieces, options.ghost_levels, context); });
}

}  // namespace sg
