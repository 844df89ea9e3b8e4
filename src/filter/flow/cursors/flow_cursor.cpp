// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "filter/flow/cursors/lattice_cursor.h"
#include "filter/flow/cursors/solid_cursor.h"
#include "filter/flow/cursors/surface_normal.h"
#include "filter/flow/cursors/tet_cursor.h"
#include "filter/flow/flow_field.h"

namespace sg {

struct FlowCursor::State {
  enum class Source : uint8_t { none, lattice, tets, solids, locator };
  const FlowField* field;
  const FlowAccess* access;
  Source source = Source::none;  // of the last answer
  std::optional<LatticeCursor> lattice;
  std::optional<TetCursor> tets;
  std::optional<SolidCursor> solids;
  std::optional<LocatorCursor> locator;  // made when it is needed
  std::optional<CellReader> reader;      // with hidden cells
  int64_t cell = -1, sized = -1, framed = -1;
  double length = 0;
  bool beside = false;  // the last place was the nearest of a surface or curve that x did not lie on
  Vec3 normal;          // of the surface at the last place
  int64_t corner[8];
  double weight[8];
  std::vector<Vec3> slopes;

  explicit State(const FlowField& f) : field(&f), access(&f.access()) {
    const PointVectors v{f.f32(), f.f64(), f.components()};
    if (access->kind == FlowAccess::Kind::lattice) lattice.emplace(access->lattice, v);
    if (access->kind == FlowAccess::Kind::tets) tets.emplace(*access, v);
    if (access->kind == FlowAccess::Kind::solids) solids.emplace(*access, v);
    if (lattice && access->any_hidden) reader.emplace(access->mesh());
  }
  LocatorCursor& by_tree() {
    if (!locator) locator.emplace(*access->locator());
    return *locator;
  }

  bool find(Vec3 x) {
    if (lattice) {
      source = Source::lattice;
      if (!lattice->find(x)) return false;
      cell = lattice->cell();
      return !reader || !reader->hidden(size_t(cell));
    }
    if (tets) {
      source = Source::tets;
      const TetCursor::Found found = tets->find(x);
      if (found == TetCursor::Found::outside) return false;
      if (found == TetCursor::Found::lost) {
        const int64_t c = by_tree().find_any(x);
        if (c < 0) return false;
        tets->set(c, x);
      }
      cell = tets->cell();
      return true;
    }
    if (solids) {
      source = Source::solids;
      const SolidCursor::Found found = solids->find(x);
      if (found == SolidCursor::Found::outside) return false;
      if (found == SolidCursor::Found::here) {
        cell = solids->cell();
        return true;
      }
      cell = by_tree().find_any(x);
      if (cell < 0 || solids->set(cell, x)) return cell >= 0;
    }
    source = Source::locator;
    return find_by_tree(x);
  }
  // On surfaces, whose lines leave them by rounding and curvature: the nearest point within a cell, unless that is at their border, where x
  // lies next to the surface rather than above it. Curves likewise: x may lie off them, but not beyond their end.
  bool find_by_tree(Vec3 x) {
    LocatorCursor& l = by_tree();
    if (!beside) {  // else the last place was not on the surface, and this one will hardly be
      cell = l.find_any(x);
      if (cell >= 0) return true;
    }
    beside = false;
    if (field->dimension() == 3 || sized < 0) return false;
    const NearestPlace near = l.nearest(x, length);
    if (near.cell < 0) return false;
    cell = l.find_any(near.at);
    if (cell < 0) return false;
    beside = true;
    const Vec3 off = x - near.at;
    const double d = sg::length(off);
    if (d <= 1e-6 * length) return true;
    return field->dimension() == 2 ? std::abs(dot(off, surface_normal())) >= 0.5 * d : std::abs(dot(off, curve_tangent())) <= 0.9 * d;
  }
  // Of the curve at the last place; zero where it has none.
  Vec3 curve_tangent() {
    CellMap& map = open_map();
    const auto at = map.reader().at();
    const CellType type = map.reader().type();
    if (map.dimension() != 1 || at.size() < 2) return {};
    if (type == CellType::line) return normalize(at[1] - at[0]);
    if (type != CellType::poly_line) return normalize(map.jacobian(by_tree().place().rst).column(0));
    const size_t piece = std::min(size_t(std::max(by_tree().place().rst.z, 0.0)), at.size() - 2);
    return normalize(at[piece + 1] - at[piece]);
  }
  CellMap& open_map() {
    CellMap& map = by_tree().map();
    if (map.reader().cell() != size_t(cell)) map.open(size_t(cell));
    return map;
  }
  Vec3 surface_normal() {
    CellMap& map = open_map();
    const auto at = map.reader().at();
    if (framed == cell) return normal;
    if (at.size() == 3 && map.reader().type() == CellType::triangle) {
      framed = cell;  // flat: the same all over the cell
      return normal = normalize(cross(at[1] - at[0], at[2] - at[0]));
    }
    framed = -1;
    return normal = sg::surface_normal(map, by_tree().place().rst);
  }
  void measure() {
    if (source == Source::lattice) {
      length = lattice->length(), sized = cell;
      return;
    }
    if (cell == sized) return;
    sized = cell;
    if (source == Source::tets || source == Source::solids) {
      length = source == Source::tets ? tets->length() : solids->length();
      return;
    }
    const Vec3 size = open_map().reader().box().size();
    const double largest = std::max({size.x, size.y, size.z});
    double product = 1;
    int n = 0;
    for (int a = 0; a < 3; ++a)
      if (size[a] > 1e-6 * largest) product *= size[a], ++n;
    length = n == 3 ? std::cbrt(product) : n == 2 ? std::sqrt(product) : product;
  }
  int make_corners() { return lattice ? lattice->corners(corner, weight) : tets->corners(corner, weight); }
  Vec3 velocity() {
    if (source == Source::lattice) return lattice->velocity();
    if (source == Source::tets) return tets->velocity();
    if (source == Source::solids) return solids->velocity();
    const auto ids = locator->ids();
    const auto weights = locator->weights();
    Vec3 v;
    for (size_t k = 0; k < ids.size(); ++k) v += field->at_point(size_t(ids[k])) * weights[k];
    if (field->dimension() == 2) {
      const Vec3 n = surface_normal();
      v = v - n * dot(n, v);
    }
    if (field->dimension() == 1) {
      const Vec3 t = curve_tangent();
      v = t * dot(t, v);
    }
    return v;
  }
};

FlowCursor::FlowCursor(const FlowField& field) : state_(std::make_unique<State>(field)) {}
FlowCursor::FlowCursor(FlowCursor&&) noexcept = default;
FlowCursor::~FlowCursor() = default;

bool FlowCursor::operator()(Vec3 x, Vec3& v) {
  State& s = *state_;
  if (!s.find(x)) return false;
  v = s.velocity();
  s.measure();
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool FlowCursor::gradient(Vec3 x, Vec3& v, Mat3& j) {
  if (!(*this)(x, v)) return false;
  State& s = *state_;
  if (s.source == State::Source::lattice) {
    j = s.lattice->gradient();
    return true;
  }
  if (s.source == State::Source::tets || s.source == State::Source::solids) {
    j = s.source == State::Source::tets ? s.tets->gradient() : s.solids->gradient();
    return true;
  }
  CellMap& map = s.open_map();
  s.slopes.resize(map.reader().ids().size());
  map.gradient_weights(s.by_tree().place(), s.slopes);
  for (auto& row : j.m)
    for (double& e : row) e = 0;
  const auto ids = map.reader().ids();
  for (size_t k = 0; k < ids.size(); ++k) {
    const Vec3 u = s.field->at_point(size_t(ids[k]));
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) j.m[a][b] += u[a] * s.slopes[k][b];
  }
  return true;
}

int64_t FlowCursor::cell() const { return state_->cell; }
double FlowCursor::cell_length() const { return state_->length; }

std::span<const int64_t> FlowCursor::ids() const {
  State& s = *state_;
  if (s.source == State::Source::locator) return s.locator->ids();
  if (s.source == State::Source::none) return {};
  if (s.source == State::Source::solids) return s.solids->ids();
  return {s.corner, size_t(s.make_corners())};
}
std::span<const double> FlowCursor::weights() const {
  State& s = *state_;
  if (s.source == State::Source::locator) return s.locator->weights();
  if (s.source == State::Source::none) return {};
  if (s.source == State::Source::solids) return s.solids->weights();
  return {s.weight, size_t(s.make_corners())};
}
const FlowField& FlowCursor::field() const { return *state_->field; }

bool FlowCursor::snap(Vec3 x, Vec3& at) {
  State& s = *state_;
  at = x;
  if (s.field->dimension() == 3) return true;
  if (s.lattice) {
    at = s.lattice->snap(x);
    return true;
  }
  const NearestPlace near = s.by_tree().nearest(x, s.sized < 0 ? HUGE_VAL : s.length);
  if (near.cell >= 0) at = near.at;
  return near.cell >= 0;
}

Vec3 FlowCursor::snap(Vec3 x) {
  Vec3 at;
  snap(x, at);
  return at;
}

}  // namespace sg
