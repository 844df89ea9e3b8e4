// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/flow_field.h"

#include "filter/field/point_cell.h"
#include "filter/flow/random_places.h"

namespace sg {

const Field& flow_field_of(const Dataset& d, const std::string& name, std::string_view who) {
  const Field* f = nullptr;
  if (!name.empty()) {
    f = &d.fields().require(name);
  } else {
    const Field* role = d.fields().with_role(Role::vectors);
    if (role && (role->components() == 2 || role->components() == 3)) f = role;
    if (!f) f = d.fields().active(3);
    if (!f) f = d.fields().active(2);
    if (!f)
      fail_usage("the data have no vector field", std::string(who), "a field of 2 or 3 components; calc makes one: calc expr='vec(u,v,0)'");
  }
  if (f->association == Association::whole)
    fail_usage(fmt::format("field '{}' belongs to the whole dataset, not to points or cells", f->name), std::string(who));
  if (f->components() != 2 && f->components() != 3)
    fail_usage(
        fmt::format("field '{}' has {} component{}, a velocity has 2 or 3", f->name, f->components(), f->components() == 1 ? "" : "s"),
        std::string(who), "name a vector field by field=");
  return *f;
}

FlowField::FlowField(DatasetPtr dataset, const std::string& name, Context& context, std::shared_ptr<const CellLocator> index)
    : dataset_(std::move(dataset)) {
  field_ = flow_field_of(*dataset_, name, "flow");
  dimension_ = cells_dimension(dataset_);
  if (dataset_->cell_count() == 0 || dimension_ < 1)
    fail_usage(fmt::format("there is no flow between the points of a mesh of {} with {} cells", dataset_->kind(), dataset_->cell_count()),
               "flow", "a grid, or cells of lines, surfaces or volume");
  locator_ = index ? std::move(index) : std::make_shared<const CellLocator>(dataset_, context);
  if (field_.association == Association::cell) {
    const DatasetPtr averaged = cell_to_point(dataset_, {{field_.name}}, context);
    field_ = averaged->fields().require(field_.name, Association::point);
  }
  packed_ = field_.array.type() == ElementType::f64   ? field_.array.made_packed()
            : field_.array.type() == ElementType::f32 ? field_.array.made_packed()
                                                      : field_.array.converted(ElementType::f32);
  components_ = field_.components();
  if (packed_.type() == ElementType::f64) f64_ = packed_.view<double>().data;
  else f32_ = packed_.view<float>().data;
  const FieldStats stats = field_stats(packed_, true);
  largest_speed_ = stats.magnitude.empty() ? 0 : stats.magnitude.hi;
}

struct FlowCursor::State {
  const FlowField* field;
  LocatorCursor locator;
  int64_t cell = -1;
  int64_t sized = -1;
  double length = 0;
  std::vector<Vec3> slopes;

  explicit State(const FlowField& f) : field(&f), locator(*f.locator()) {}

  // On surfaces, whose lines leave them by rounding and curvature: the nearest place within a cell.
  bool find(Vec3 x) {
    cell = locator.find(x);
    if (cell >= 0 || field->dimension() == 3 || sized < 0) return cell >= 0;
    const NearestPlace near = locator.nearest(x, length);
    if (near.cell >= 0) cell = locator.find(near.at);
    return cell >= 0;
  }
  void measure() {
    if (cell == sized) return;
    sized = cell;
    CellMap& map = locator.map();
    if (map.reader().cell() != size_t(cell)) map.open(size_t(cell));
    const Vec3 size = map.reader().box().size();
    const double largest = std::max({size.x, size.y, size.z});
    double product = 1;
    int n = 0;
    for (int a = 0; a < 3; ++a)
      if (size[a] > 1e-6 * largest) product *= size[a], ++n;
    length = n == 3 ? std::cbrt(product) : n == 2 ? std::sqrt(product) : product;
  }
};

FlowCursor::FlowCursor(const FlowField& field) : state_(std::make_unique<State>(field)) {}
FlowCursor::FlowCursor(FlowCursor&&) noexcept = default;
FlowCursor::~FlowCursor() = default;

bool FlowCursor::operator()(Vec3 x, Vec3& v) {
  State& s = *state_;
  if (!s.find(x)) return false;
  const auto ids = s.locator.ids();
  const auto weights = s.locator.weights();
  v = {0, 0, 0};
  for (size_t k = 0; k < ids.size(); ++k) v += s.field->at_point(size_t(ids[k])) * weights[k];
  s.measure();
  if (s.field->dimension() == 2) {
    CellMap& map = s.locator.map();
    if (map.reader().cell() != size_t(s.cell)) map.open(size_t(s.cell));
    const Mat3 j = map.jacobian(s.locator.place().rst);
    const Vec3 n = normalize(cross(j.column(0), j.column(1)));
    v = v - n * dot(n, v);
  }
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool FlowCursor::gradient(Vec3 x, Vec3& v, Mat3& j) {
  if (!(*this)(x, v)) return false;
  State& s = *state_;
  CellMap& map = s.locator.map();
  if (map.reader().cell() != size_t(s.cell)) map.open(size_t(s.cell));
  s.slopes.resize(map.reader().ids().size());
  map.gradient_weights(s.locator.place(), s.slopes);
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
std::span<const int64_t> FlowCursor::ids() const { return state_->locator.ids(); }
std::span<const double> FlowCursor::weights() const { return state_->locator.weights(); }
const FlowField& FlowCursor::field() const { return *state_->field; }

bool FlowCursor::snap(Vec3 x, Vec3& at) {
  State& s = *state_;
  at = x;
  if (s.field->dimension() == 3) return true;
  const NearestPlace near = s.locator.nearest(x, s.sized < 0 ? HUGE_VAL : s.length);
  if (near.cell >= 0) at = near.at;
  return near.cell >= 0;
}

Vec3 FlowCursor::snap(Vec3 x) {
  Vec3 at;
  snap(x, at);
  return at;
}

}  // namespace sg
