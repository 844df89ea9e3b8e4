// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/unsteady/unsteady_flow.h"

namespace sg {

namespace {

// A place in the mesh of one step, for all steps that share it.
class MeshPlace {
 public:
  explicit MeshPlace(const FlowField& field) : locator_(*field.locator()), dimension_(field.dimension()) {}

  // On surfaces, whose lines leave them by rounding and curvature: the nearest place within a cell.
  bool find(Vec3 x) {
    cell_ = locator_.find(x);
    if (cell_ < 0 && dimension_ < 3 && sized_ >= 0) {
      const NearestPlace near = locator_.nearest(x, length_);
      if (near.cell >= 0) cell_ = locator_.find(near.at);
    }
    return cell_ >= 0;
  }
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

  Vec3 along_surface(Vec3 v) {
    if (dimension_ != 2) return v;
    const Mat3 j = open().jacobian(locator_.place().rst);
    const Vec3 n = normalize(cross(j.column(0), j.column(1)));
    return v - n * dot(n, v);
  }

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
  std::vector<MeshPlace> places;  // one, or one a step when the meshes changed
  double w[4] = {0, 0, 0, 0};     // of the steps at the last time
  double weighed = NAN;           // that time
  size_t main = 0;                // the place that says what a cell is
  Vec3 shift{0, 0, 0};            // moving meshes: from the place in the base mesh to that at the last time

  explicit State(const UnsteadyFlow& f) : flow(f) {
    if (f.meshes() == UnsteadyFlow::Meshes::changed)
      for (const FlowField& s : f.steps()) places.emplace_back(s);
    else places.emplace_back(f.steps()[f.base()]);
  }

  MeshPlace& of(size_t j) { return places[places.size() > 1 ? j : 0]; }

  Vec3 velocity(size_t j) {
    const auto ids = of(j).ids();
    const auto n = of(j).weights();
    Vec3 v;
    for (size_t k = 0; k < ids.size(); ++k) v += flow.steps()[j].at_point(size_t(ids[k])) * n[k];
    return v;
  }

  // How far the place found in the base mesh has moved.
  Vec3 moved() {
    const auto ids = places[0].ids();
    const auto n = places[0].weights();
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
    MeshPlace& p = places[0];
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

  // Steps whose mesh does not hold x do not count; the one nearest in time has to.
  bool mix_changed(Vec3 x, Vec3& v) {
    const size_t b = flow.base();
    bool have[4] = {};
    bool all = true;
    for (size_t j = 0; j < flow.steps().size(); ++j)
      if (w[j] != 0) have[j] = places[j].find(x), all = all && have[j];
    const double s = (weighed - flow.begin()) / (flow.end() - flow.begin());
    main = s <= 0.5 ? b : b + 1;
    if (!have[main]) return false;
    double mix[4] = {w[0], w[1], w[2], w[3]};
    if (!all) {  // cubic weights need all steps
      for (double& m : mix) m = 0;
      if (have[b]) mix[b] = have[b + 1] ? 1 - s : 1;
      if (have[b + 1]) mix[b + 1] = have[b] ? s : 1;
      for (int j = 0; j < 4; ++j) w[j] = mix[j];
      weighed = NAN;
    }
    v = {0, 0, 0};
    for (size_t j = 0; j < flow.steps().size(); ++j)
      if (mix[j] != 0) v += velocity(j) * mix[j];
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
  if (s.places.size() > 1) {
    if (!s.mix_changed(x, v)) return false;
  } else {
    if (s.flow.meshes() == UnsteadyFlow::Meshes::moving ? !s.find_moving(x) : !s.places[0].find(x)) return false;
    v = {0, 0, 0};
    for (size_t j = 0; j < s.flow.steps().size(); ++j)
      if (s.w[j] != 0) v += s.velocity(j) * s.w[j];
  }
  MeshPlace& p = s.of(s.main);
  p.measure();
  v = p.along_surface(v);
  return finite(v);
}

double UnsteadyCursor::cell_length() const { return state_->of(state_->main).length(); }

Vec3 UnsteadyCursor::snap(Vec3 x) {
  State& s = *state_;
  MeshPlace& p = s.of(s.main);
  if (p.dimension() == 3) return x;
  const bool moving = s.flow.meshes() == UnsteadyFlow::Meshes::moving;
  const NearestPlace near = p.nearest(moving ? x - s.shift : x);
  return near.cell < 0 ? x : moving ? near.at + s.shift : near.at;
}

double UnsteadyCursor::value(std::span<const Array> values, Association association, int component) const {
  State& s = *state_;
  double sum = 0;
  for (size_t j = 0; j < s.flow.steps().size(); ++j) {
    if (s.w[j] == 0) continue;
    MeshPlace& p = s.of(j);
    if (values[j].empty() || p.cell() < 0) return NAN;
    if (association == Association::cell) {
      sum += s.w[j] * values[j].get(size_t(p.cell()), component);
      continue;
    }
    const auto ids = p.ids();
    const auto n = p.weights();
    for (size_t k = 0; k < ids.size(); ++k) sum += s.w[j] * n[k] * values[j].get(size_t(ids[k]), component);
  }
  return sum;
}

}  // namespace sg
