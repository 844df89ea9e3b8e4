// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>

#include "filter/flow/cursors/surface_normal.h"
#include "filter/flow/unsteady/unsteady_flow.h"

namespace sg {

namespace {

// A place in the base mesh when meshes move.
class MeshPlace {
 public:
  explicit MeshPlace(const FlowField& field) : locator_(*field.locator()), dimension_(field.dimension()) {}

  bool find(Vec3 x) { return (cell_ = locator_.find(x)) >= 0; }
  bool find_nearest(Vec3 x, Vec3& at) {
    const NearestPlace near = locator_.nearest(x);
    at = near.at;
    cell_ = near.cell >= 0 ? locator_.find(near.at) : -1;
    return cell_ >= 0;
  }
  NearestPlace nearest(Vec3 x) { return locator_.nearest(x, sized_ < 0 ? HUGE_VAL : length_); }

  int64_t cell() const { return cell_; }
  int dimension() const { return dimension_; }
  std::span<const int64_t> ids() const { return locator_.ids(); }
  std::span<const double> weights() const { return locator_.weights(); }

  double measure() {
    if (cell_ == sized_) return length_;
    sized_ = cell_;
    const Vec3 size = open().reader().box().size();
    const double largest = std::max({size.x, size.y, size.z});
    double product = 1;
    int n = 0;
    for (int a = 0; a < 3; ++a)
      if (size[a] > 1e-6 * largest) product *= size[a], ++n;
    return length_ = n == 3 ? std::cbrt(product) : n == 2 ? std::sqrt(product) : product;
  }
  double length() const { return length_; }

  Vec3 normal() { return surface_normal(open(), locator_.place().rst); }

 private:
  CellMap& open() {
    CellMap& map = locator_.map();
    if (map.reader().cell() != size_t(cell_)) map.open(size_t(cell_));
    return map;
  }
  LocatorCursor locator_;
  int dimension_;
  int64_t cell_ = -1, sized_ = -1;
  double length_ = 0;
};

bool finite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

struct UnsteadyCursor::State {
  const UnsteadyFlow& flow;
  // One mesh of solids: one cursor, whose place serves all steps. Surfaces and changed meshes: a cursor a step, but for a steady flow.
  std::vector<FlowCursor> cursors;
  bool steady = false;                          // a surface or curve, all steps the same numbers
  bool have[4] = {false, false, false, false};  // which cursors are at the last place
  std::optional<MeshPlace> moving;
  double w[4] = {0, 0, 0, 0};  // of the steps at the last time
  double weighed = NAN;        // that time
  size_t main = 0;             // the cursor that determines the cell
  Vec3 shift{0, 0, 0};         // moving meshes: from the place in the base mesh to that at the last time

  explicit State(const UnsteadyFlow& f) : flow(f) {
    if (f.meshes() == UnsteadyFlow::Meshes::moving) {
      moving.emplace(f.steps()[f.base()]);
    } else if (f.meshes() == UnsteadyFlow::Meshes::same && f.steps()[0].dimension() == 3) {
      cursors.emplace_back(f.steps()[f.base()]);
    } else if (f.meshes() == UnsteadyFlow::Meshes::same && same_numbers(f)) {
      steady = true;
      cursors.emplace_back(f.steps()[f.base()]);
    } else {
      for (const FlowField& s : f.steps()) cursors.emplace_back(s);
      main = f.base();
    }
  }

  Vec3 mixed(std::span<const int64_t> ids, std::span<const double> n, size_t j) const {
    Vec3 v;
    for (size_t k = 0; k < ids.size(); ++k) v += flow.steps()[j].at_point(size_t(ids[k])) * n[k];
    return v;
  }

  static bool same_numbers(const UnsteadyFlow& f) {
    const FlowField& first = f.steps()[0];
    return std::all_of(f.steps().begin(), f.steps().end(),
                       [&](const FlowField& s) { return s.f32() == first.f32() && s.f64() == first.f64(); });
  }

  bool mix_one(Vec3 x, Vec3& v) {
    FlowCursor& c = cursors[0];
    if (steady) return c(x, v);
    Vec3 own;
    if (!c(x, own)) return false;
    const auto ids = c.ids();
    const auto n = c.weights();
    v = own * w[flow.base()];
    for (size_t j = 0; j < flow.steps().size(); ++j)
      if (w[j] != 0 && j != flow.base()) v += mixed(ids, n, j) * w[j];
    return true;
  }
  bool mix_moving(Vec3 x, Vec3& v) {
    if (!find_moving(x)) return false;
    v = {0, 0, 0};
    for (size_t j = 0; j < flow.steps().size(); ++j)
      if (w[j] != 0) v += mixed(moving->ids(), moving->weights(), j) * w[j];
    moving->measure();
    if (moving->dimension() == 2) {
      const Vec3 n = moving->normal();
      v = v - n * dot(n, v);
    }
    return true;
  }

  // How far the place found in the base mesh has moved.
  Vec3 moved() {
    const auto ids = moving->ids();
    const auto n = moving->weights();
    Vec3 at, from;
    for (size_t j = 0; j < flow.steps().size(); ++j) {
      if (w[j] == 0 && j != flow.base()) continue;
      const double* p = flow.positions()[j].view<double>().data;
      Vec3 sum;
      for (size_t k = 0; k < ids.size(); ++k) {
        const double* q = p + 3 * size_t(ids[k]);
        sum += Vec3(q[0], q[1], q[2]) * n[k];
      }
      at += sum * w[j];
      if (j == flow.base()) from = sum;
    }
    return at - from;
  }

  // The place y of the base mesh with y + moved(y) = x, by iteration; the mesh of that time holds x when the base mesh holds y.
  bool find_moving(Vec3 x) {
    MeshPlace& p = *moving;
    Vec3 y = x;
    double before = HUGE_VAL;
    for (int n = 0, worse = 0; n < 40 && worse < 3; ++n) {
      if (!p.find(y) && !p.find_nearest(y, y)) return false;
      shift = moved();
      const Vec3 rest = x - shift - y;
      if (length(rest) <= 1e-8 * p.measure()) return true;
      worse += length(rest) > 0.9 * before;  // the nearest place stays the same border
      before = length(rest);
      y = y + rest;
    }
    return false;
  }

  // Steps whose mesh does not hold x do not count; the one nearest in time has to. With one mesh all hold it, or there is NaN.
  bool mix_several(Vec3 x, Vec3& v) {
    const size_t b = flow.base();
    bool all = true;
    Vec3 each[4];
    for (size_t j = 0; j < flow.steps().size(); ++j) {
      have[j] = w[j] != 0 && cursors[j](x, each[j]);
      all = all && (have[j] || w[j] == 0);
    }
    const double s = (weighed - flow.begin()) / (flow.end() - flow.begin());
    main = s <= 0.5 ? b : b + 1;
    if (!have[main] && w[main] != 0) return false;
    if (!have[main]) main = main == b ? b + 1 : b;
    if (!have[main] || (!all && flow.meshes() == UnsteadyFlow::Meshes::same)) return false;
    if (!all) {  // cubic weights need all steps
      const double mix[2] = {have[b] ? (have[b + 1] ? 1 - s : 1) : 0, have[b + 1] ? (have[b] ? s : 1) : 0};
      for (double& m : w) m = 0;
      w[b] = mix[0], w[b + 1] = mix[1];
      weighed = NAN;
    }
    v = {0, 0, 0};
    for (size_t j = 0; j < flow.steps().size(); ++j)
      if (w[j] != 0) v += each[j] * w[j];
    return true;
  }
};

UnsteadyCursor::UnsteadyCursor(const UnsteadyFlow& flow) : state_(std::make_unique<State>(flow)) {}
UnsteadyCursor::UnsteadyCursor(UnsteadyCursor&&) noexcept = default;
UnsteadyCursor::~UnsteadyCursor() = default;

bool UnsteadyCursor::operator()(Vec3 x, double t, Vec3& v) {
  State& s = *state_;
  const double slack = 1e-9 * (s.flow.end() - s.flow.begin());
  if (!(t >= s.flow.begin() - slack && t <= s.flow.end() + slack)) return false;
  if (t != s.weighed) s.flow.time_weights(t, s.w), s.weighed = t;
  if (!(s.moving ? s.mix_moving(x, v) : s.cursors.size() == 1 ? s.mix_one(x, v) : s.mix_several(x, v))) return false;
  return finite(v);
}

double UnsteadyCursor::cell_length() const {
  return state_->moving ? state_->moving->length() : state_->cursors[state_->main].cell_length();
}

Vec3 UnsteadyCursor::snap(Vec3 x) {
  State& s = *state_;
  if (s.flow.steps()[0].dimension() == 3) return x;
  Vec3 at = x;
  if (!s.moving) {
    FlowCursor& c = s.cursors[s.main];
    return c.snap(x, at) ? at : x;
  }
  const NearestPlace near = s.moving->nearest(x - s.shift);
  return near.cell < 0 ? x : near.at + s.shift;
}

double UnsteadyCursor::value(std::span<const Array> values, Association association, int component) const {
  State& s = *state_;
  double sum = 0;
  for (size_t j = 0; j < s.flow.steps().size(); ++j) {
    if (s.w[j] == 0) continue;
    const FlowCursor* c = s.moving ? nullptr : &s.cursors[s.cursors.size() == 1 ? 0 : j];
    const int64_t cell = c ? c->cell() : s.moving->cell();
    if (values[j].empty() || cell < 0) return NAN;
    if (association == Association::cell) {
      sum += s.w[j] * values[j].get(size_t(cell), component);
      continue;
    }
    const auto ids = c ? c->ids() : s.moving->ids();
    const auto n = c ? c->weights() : s.moving->weights();
    for (size_t k = 0; k < ids.size(); ++k) sum += s.w[j] * n[k] * values[j].get(size_t(ids[k]), component);
  }
  return sum;
}

}  // namespace sg
