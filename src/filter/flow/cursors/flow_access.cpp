// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/cursors/flow_access.h"

#include "data/cells/mesh_dimension.h"
#include "data/memory/memo.h"

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

FlowAccess::FlowAccess(DatasetPtr mesh, std::shared_ptr<const CellLocator> index, const Context& context)
    : mesh_(index ? index->dataset() : std::move(mesh)), locator_(std::move(index)) {
  const Dataset& d = *mesh_;
  any_hidden = !d.cell_ghost().empty() || !d.point_ghost().empty();
  if (auto l = lattice_flow(d)) {
    lattice = std::move(*l);
    kind = Kind::lattice;
    return;
  }
  if (d.cell_count() == 0 || d.cell_count() >= size_t(INT32_MAX)) return;
  if (const auto* c = d.as<CurvilinearGrid>()) {
    if (c->dims[0] > 1 && c->dims[1] > 1 && c->dims[2] > 1) open_curvilinear(context);
    return;
  }
  if (!d.as<UnstructuredMesh>()) return;
  simplices = SimplexArrays(d);
  if (simplices.all(CellType::tetra) && !any_hidden) open_tets(context);
  else if (mesh_dimension(d) == 3) open_solids(context);
}

template <class Corner, class Takes>
void FlowAccess::make_start(size_t cells, Corner&& corner, Takes&& takes) {
  constexpr const char* key = "flow/walk_start";
  start = mesh_->memo().find<WalkStart>(key);
  if (start) return;
  WalkStart made(mesh_->bounds(), cells, corner, takes);
  const size_t bytes = made.bytes();
  start = mesh_->memo().keep<WalkStart>(key, std::move(made), bytes);
}

void FlowAccess::open_curvilinear(const Context&) {
  curvilinear = std::make_shared<const Lattice>(mesh_->mesh());
  const LatticeView& v = curvilinear->view();
  const auto n = v.cell_dims();
  const CellReader reader(mesh_);
  make_start(
      mesh_->cell_count(), [&](size_t c) { return v.position(c % n[0], c / n[0] % n[1], c / n[0] / n[1]); },
      [&](size_t c) { return !any_hidden || !reader.hidden(c); });
  kind = Kind::solids;
}

void FlowAccess::open_tets(const Context& context) {
  using Across = std::vector<int32_t, HugeAllocator<int32_t>>;
  constexpr const char* key = "flow/tet_neighbors";
  tets = mesh_->memo().find<Across>(key);
  if (!tets) {
    Across made = tet_neighbors(simplices.cells, mesh_->point_count(), context);
    const size_t bytes = made.size() * 4;
    tets = mesh_->memo().keep<Across>(key, std::move(made), bytes);
  }
  make_start(
      simplices.cells.count, [&](size_t c) { return simplices.point(simplices.id(c, 0)); }, [](size_t) { return true; });
  kind = Kind::tets;
}

void FlowAccess::open_solids(const Context& context) {
  constexpr const char* key = "flow/cell_neighbors";
  neighbors = mesh_->memo().find<CellNeighbors>(key);
  if (!neighbors) {
    CellNeighbors made = cell_neighbors(mesh_->mesh(), &context);
    const size_t bytes = made.across.size() * 4 + made.begin.size() * 8;
    neighbors = mesh_->memo().keep<CellNeighbors>(key, std::move(made), bytes);
  }
  const CellReader reader(mesh_);
  make_start(
      simplices.cells.count, [&](size_t c) { return simplices.point(simplices.id(c, 0)); },
      [&](size_t c) { return cell_type_info(cell_type(c)).dimension == 3 && (!any_hidden || !reader.hidden(c)); });
  kind = Kind::solids;
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
