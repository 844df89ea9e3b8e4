// SPDX-License-Identifier: Apache-2.0
// Which cell holds a point. Nearest points and rays: cell_locator_rays.cpp.
#include "index/cell_locator.h"

#include "base/parallel.h"
#include "index/cell_locator_index.h"

namespace sg {

namespace {

// Whether the mesh has cells that are not solids.
bool has_low_cells(const Dataset& d) {
  if (const auto* u = d.as<UnstructuredMesh>()) {
    if (u->types.empty()) return cell_type_info(u->single_type).dimension < 3;
    const auto types = u->types.view<uint8_t>();
    return parallel_reduce(
        types.count, 1 << 16, false,
        [&](size_t begin, size_t end) {
          bool low = false;
          for (size_t i = begin; i < end; ++i) low = low || cell_type_info(CellType(types[i])).dimension < 3;
          return low;
        },
        [](bool a, bool b) { return a || b; });
  }
  if (const auto* c = d.as<CurvilinearGrid>()) return c->dims[0] < 2 || c->dims[1] < 2 || c->dims[2] < 2;
  return true;
}

}  // namespace

CellLocator::Index::Index(DatasetPtr d, Context& context) : dataset(std::move(d)), map(dataset) {
  const Dataset& data = *dataset;
  any_hidden = !data.cell_ghost().empty() || !data.point_ghost().empty();
  slack = locate_slack(data);
  if (data.as<UniformGrid>() || data.as<RectilinearGrid>()) {
    kind = Kind::grid;
    lattice.emplace(data.mesh());
    if (data.point_count() > 0) grid.emplace(lattice->view());
    return;
  }
  if (const auto* amr = data.as<AmrGrid>()) {
    open_amr(*amr, context);
    return;
  }
  kind = data.as<PointCloud>() ? Kind::points : Kind::tree;
  simplices = SimplexArrays(data);
  tree_slack = has_low_cells(data) ? slack : 0;
  std::call_once(once_, [&] { tree_.emplace(dataset, context); });
}

void CellLocator::Index::open_amr(const AmrGrid& amr, Context& context) {
  kind = Kind::amr;
  size_t cell = 0, point = 0;
  std::vector<Box3> boxes;
  for (size_t l = 0; l < amr.levels.size(); ++l)
    for (const auto& p : amr.levels[l].patches) {
      const auto n = p.cells();
      const bool solid = amr.dimension == 3;
      LatticeView v;
      v.dims = {n[0] + 1, n[1] + 1, solid ? n[2] + 1 : 1};
      const Vec3 h = amr.levels[l].spacing;
      v.origin = amr.origin + Vec3(double(p.lo[0]), double(p.lo[1]), solid ? double(p.lo[2]) : 0.0) * h;
      for (int a = 0; a < 3; ++a) v.step[a][a] = h[a];
      Box3 b;
      b.add(v.origin), b.add(v.origin + Vec3(double(n[0]), double(n[1]), solid ? double(n[2]) : 0.0) * h);
      boxes.push_back(b);
      patches.push_back({GridIndex(v), int(l), cell, n[0] * n[1] * n[2], point, b, {}});
      cell += n[0] * n[1] * n[2], point += v.points();
    }
  patch_tree.emplace(boxes, context);
  for (Patch& p : patches)
    patch_tree->overlapping(p.box, [&](uint32_t q) {
      if (patches[q].level >= p.level && &patches[q] != &p) p.rivals.push_back(q);
    });
}

const CellTree& CellLocator::Index::tree() const {
  std::call_once(once_, [&] {
    Context context;
    tree_.emplace(dataset, context);
  });
  return *tree_;
}

CellLocator::CellLocator(DatasetPtr dataset, Context& context) : index_(std::make_unique<Index>(std::move(dataset), context)) {}
CellLocator::~CellLocator() = default;
const DatasetPtr& CellLocator::dataset() const { return index_->dataset; }

LocatorCursor::LocatorCursor(const CellLocator& locator) : state_(std::make_unique<State>(locator.index())) {}
LocatorCursor::~LocatorCursor() = default;
LocatorCursor::LocatorCursor(LocatorCursor&&) noexcept = default;

// Whether nothing but the patch of the last answer can hold x: it is well inside, and in none that goes before.
bool LocatorCursor::State::same_patch(Vec3 x) {
  constexpr size_t few = 32;
  const auto inside = [&](const Box3& b, double margin) {
    const Vec3 size = b.size();
    for (int a = 0; a < 3; ++a) {
      const double m = margin * (index->slack + 1e-6 * size[a]);
      if (!(x[a] >= b.lo[a] + m && x[a] <= b.hi[a] - m)) return false;
    }
    return true;
  };
  if (!patch || patch->rivals.size() > few || !inside(patch->box, 1)) return false;
  for (const uint32_t q : patch->rivals)
    if (inside(index->patches[q].box, -1)) return false;
  return true;
}

int64_t LocatorCursor::State::find_amr(Vec3 x) {
  if (same_patch(x)) {
    CellPlace at;
    const int64_t c = patch->grid.find(
        x, index->slack, [&](size_t local) { return hidden(patch->cell_begin + local); }, at);
    if (c >= 0) {
      place = at;
      return c + int64_t(patch->cell_begin);
    }
  }
  int level = -1;
  int64_t best = -1;
  index->patch_tree->cells_at(x, index->slack, [&](uint32_t p) {
    const CellLocator::Index::Patch& to = index->patches[p];
    if (to.level < level) return false;
    CellPlace at;
    int64_t c = to.grid.find(
        x, index->slack, [&](size_t local) { return hidden(to.cell_begin + local); }, at);
    if (c < 0) return false;
    c += int64_t(to.cell_begin);
    if (to.level > level || c < best) level = to.level, best = c, place = at, patch = &to;
    return false;
  });
  return best;
}

// The cell of the last answer is only a bound for the search: whether it is the smallest that holds x has still to be shown.
int64_t LocatorCursor::State::find_tree(Vec3 x) {
  const CellTree& tree = index->tree();
  int64_t best = INT64_MAX;
  if (cell >= 0) {
    CellPlace at;
    if (probe.holds(size_t(cell), x, at)) best = cell, place = at;
  }
  const SimplexArrays& s = index->simplices;
  if (s.all(CellType::tetra)) {
    tree.cells_at(x, 0, [&](uint32_t c) {
      if (int64_t(c) >= best) return false;
      const size_t b = s.cells.begin(c);
      const IndexView& ids = s.cells.connectivity;
      const Vec3 p = s.point(ids[b]), q = s.point(ids[b + 1]);
      const Vec3 r = tetra_coordinates(x, p, q, s.point(ids[b + 2]), s.point(ids[b + 3]));
      if (in_tetra(r, tetra_tolerance(s.ease, q - p))) best = c, place = {r, 0, x, 0};
      return false;
    });
  } else {
    tree.cells_at(x, index->tree_slack, [&](uint32_t c) {
      CellPlace at;
      if (int64_t(c) < best && probe.holds(c, x, at)) best = c, place = at;
      return false;
    });
  }
  return best == INT64_MAX ? -1 : best;
}

int64_t LocatorCursor::State::find_point(Vec3 x) {
  int64_t best = -1;
  double d2 = HUGE_VAL;
  const Points& points = index->dataset->as<PointCloud>()->points;
  index->tree().nearest(x, HUGE_VAL, [&](uint32_t c) {
    const Vec3 p = points.at(c), v = p - x;
    const double e = dot(v, v);
    if (e < d2 || (e == d2 && int64_t(c) < best)) d2 = e, best = c, place = {Vec3(), 0, p, e};
    return d2;
  });
  return best;
}

int64_t LocatorCursor::find(Vec3 x) {
  State& s = *state_;
  s.weights_ready = false;
  if (!std::isfinite(x.x + x.y + x.z)) return s.cell = -1;
  switch (s.index->kind) {
    case CellLocator::Index::Kind::grid:
      s.cell = s.index->grid ? s.index->grid->find(
                                   x, s.index->slack, [&](size_t c) { return s.hidden(c); }, s.place)
                             : -1;
      break;
    case CellLocator::Index::Kind::amr: s.cell = s.find_amr(x); break;
    case CellLocator::Index::Kind::tree: s.cell = s.find_tree(x); break;
    case CellLocator::Index::Kind::points: s.cell = s.find_point(x); break;
  }
  return s.cell;
}

int64_t LocatorCursor::find_any(Vec3 x) {
  State& s = *state_;
  if (s.index->kind != CellLocator::Index::Kind::tree) return find(x);
  s.weights_ready = false;
  if (!std::isfinite(x.x + x.y + x.z)) return s.cell = -1;
  CellPlace at;
  if (s.cell >= 0 && s.probe.holds(size_t(s.cell), x, at)) {
    s.place = at;
    return s.cell;
  }
  int64_t found = -1;
  s.index->tree().cells_at(x, s.index->tree_slack, [&](uint32_t c) {
    if (!s.probe.holds(c, x, at)) return false;
    found = c, s.place = at;
    return true;
  });
  return s.cell = found;
}

void LocatorCursor::State::make_weights() {
  if (weights_ready) return;
  weights_ready = true;
  if (cell < 0) return ids.clear(), weights.clear();
  const auto kind = index->kind;
  if (kind == CellLocator::Index::Kind::points) {
    ids.assign(1, cell), weights.assign(1, 1.0);
  } else if (kind == CellLocator::Index::Kind::tree) {
    probe.weights(size_t(cell), place, ids, weights);
  } else {
    const GridIndex& grid = patch ? patch->grid : *index->grid;
    ids.resize(8), weights.resize(8);
    const size_t n = size_t(grid.weights(cell - int64_t(patch ? patch->cell_begin : 0), place, ids.data(), weights.data()));
    ids.resize(n), weights.resize(n);
    if (patch)
      for (int64_t& id : ids) id += int64_t(patch->point_begin);
  }
}

std::span<const int64_t> LocatorCursor::ids() const { return state_->make_weights(), state_->ids; }
std::span<const double> LocatorCursor::weights() const { return state_->make_weights(), state_->weights; }
const CellPlace& LocatorCursor::place() const { return state_->place; }
CellMap& LocatorCursor::map() { return state_->cell >= 0 ? state_->probe.open(size_t(state_->cell)) : state_->probe.map(); }

}  // namespace sg
