// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/flow_access.h"

#include "data/memo.h"

namespace sg {

namespace {

std::optional<LatticeFlow> lattice_flow(const Dataset& d) {
  if (!d.as<UniformGrid>() && !d.as<RectilinearGrid>()) return std::nullopt;
  LatticeFlow l;
  l.keep = std::make_shared<const Lattice>(d.mesh());
  const LatticeView& v = l.keep->view();
  l.separable = v.mode == LatticeView::Mode::separable;
  const std::array<size_t, 3> across{1, v.dims[0], v.dims[0] * v.dims[1]};
  for (int a = 0; a < 3; ++a) {
    const size_t n = v.dims[size_t(a)];
    if (n < 2 && l.flat_axis >= 0) return std::nullopt;  // a line or a point
    if (n < 2) l.flat_axis = a;
    else l.cells[size_t(a)] = n - 1, l.stride[size_t(a)] = across[size_t(a)];
    l.axis[a] = v.axis[a], l.step[a] = v.step[a];
  }
  l.origin = v.origin;
  if (l.separable) {
    if (l.flat_axis >= 0) l.normal[l.flat_axis] = 1;
    return l;
  }
  // The axis without cells gets a unit step across the others: its coordinate is a distance.
  if (const int a = l.flat_axis; a >= 0) l.step[a] = l.normal = normalize(cross(l.step[(a + 1) % 3], l.step[(a + 2) % 3]));
  const Vec3 &u = l.step[0], &w = l.step[1], &t = l.step[2];
  const double volume = dot(u, cross(w, t));
  if (!(std::abs(volume) > 0)) return std::nullopt;
  l.rows[0] = cross(w, t) / volume, l.rows[1] = cross(t, u) / volume, l.rows[2] = cross(u, w) / volume;
  double product = 1;
  for (int a = 0; a < 3; ++a)
    if (a != l.flat_axis) product *= length(l.step[a]);
  l.length = l.flat_axis < 0 ? std::cbrt(product) : std::sqrt(product);
  return l;
}

}  // namespace

TetWalk make_tet_walk(const Dataset& mesh, const SimplexArrays& s, const Context& context) {
  TetWalk w;
  w.across = tet_neighbors(s.cells, mesh.point_count(), context);
  w.box = mesh.bounds();
  const size_t n = std::clamp<size_t>(size_t(std::cbrt(double(s.cells.count) / 16)), 1, 64);
  w.bins = {n, n, n};
  w.start.assign(n * n * n, -1);
  // Every few cells one by its first corner; bins that stay empty take the one before.
  const size_t stride = s.cells.count > 4096 ? 4 : 1;
  for (size_t c = 0; c < s.cells.count; c += stride) {
    const Vec3 p = s.point(s.id(c, 0));
    size_t at[3];
    for (int a = 0; a < 3; ++a) {
      const double e = w.box.hi[a] - w.box.lo[a], f = e > 0 ? (p[a] - w.box.lo[a]) / e * double(n) : 0;
      at[a] = size_t(std::min(std::max(f, 0.0), double(n - 1)));
    }
    w.start[at[0] + n * (at[1] + n * at[2])] = int32_t(c);
  }
  int32_t last = 0;
  for (int32_t& c : w.start) {
    if (c < 0) c = last;
    last = c;
  }
  return w;
}

FlowAccess::FlowAccess(DatasetPtr mesh, std::shared_ptr<const CellLocator> index, const Context& context)
    : mesh_(index ? index->dataset() : std::move(mesh)), locator_(std::move(index)) {
  const Dataset& d = *mesh_;
  any_hidden = !d.cell_ghost().empty() || !d.point_ghost().empty();
  if (auto l = lattice_flow(d)) {
    lattice = std::move(*l);
    kind = Kind::lattice;
    return;
  }
  if (const auto* c = d.as<CurvilinearGrid>(); c && !any_hidden && c->dims[0] > 1 && c->dims[1] > 1 && c->dims[2] > 1) {
    curvilinear = std::make_shared<const Lattice>(d.mesh());
    kind = Kind::hexes;
    return;
  }
  const auto* u = d.as<UnstructuredMesh>();
  if (!u || any_hidden || d.cell_count() == 0 || d.cell_count() >= size_t(INT32_MAX)) return;
  simplices = SimplexArrays(d);
  const auto hexahedron = [](uint8_t t) { return t == uint8_t(CellType::hexahedron); };
  if (simplices.types ? std::all_of(simplices.types, simplices.types + simplices.cells.count, hexahedron)
                      : simplices.single == CellType::hexahedron) {
    constexpr const char* key = "flow/hex_neighbors";
    hex_neighbors = d.memo().find<CellNeighbors>(key);
    if (!hex_neighbors) {
      CellNeighbors made = cell_neighbors(d.mesh(), &context);
      const size_t bytes = made.across.size() * 4;
      hex_neighbors = d.memo().keep<CellNeighbors>(key, std::move(made), bytes);
    }
    if (hex_neighbors->fixed == 6) kind = Kind::hexes;
    return;
  }
  if (!simplices.all(CellType::tetra)) return;
  constexpr const char* key = "flow/tet_walk";
  walk = d.memo().find<TetWalk>(key);
  if (!walk) {
    TetWalk made = make_tet_walk(d, simplices, context);
    const size_t bytes = made.bytes();
    walk = d.memo().keep<TetWalk>(key, std::move(made), bytes);
  }
  kind = Kind::tets;
}

const std::shared_ptr<const CellLocator>& FlowAccess::locator() const {
  std::call_once(once_, [&] {
    if (locator_) return;
    Context quiet;
    locator_ = std::make_shared<const CellLocator>(mesh_, quiet);
  });
  return locator_;
}

}  // namespace sg
