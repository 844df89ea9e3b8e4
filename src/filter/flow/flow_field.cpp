// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/flow_field.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "data/cells/mesh_dimension.h"
#include "filter/field/sampling/point_cell.h"
#include "filter/flow/cursors/flow_access.h"

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
      fail_usage("the data has no vector field", std::string(who),
                 "a flow needs a field of 2 or 3 components; calc can make one: calc expr='vec(u,v,0)'");
  }
  if (f->association == Association::whole)
    fail_usage(fmt::format("field '{}' belongs to the whole dataset, not to points or cells", f->name), std::string(who));
  if (f->components() != 2 && f->components() != 3)
    fail_usage(
        fmt::format("field '{}' has {} component{}; a velocity has 2 or 3", f->name, f->components(), f->components() == 1 ? "" : "s"),
        std::string(who), "name a vector field with field=");
  return *f;
}

FlowField::FlowField(DatasetPtr dataset, const std::string& name, Context& context, std::shared_ptr<const CellLocator> index)
    : dataset_(std::move(dataset)) {
  field_ = flow_field_of(*dataset_, name, "flow");
  dimension_ = mesh_dimension(*dataset_);
  if (dataset_->cell_count() == 0 || dimension_ < 1)
    fail_usage(fmt::format("a mesh of kind {} with {} cells has no flow between its points", dataset_->kind(), dataset_->cell_count()),
               "flow", "use a grid, or a mesh with line, surface or volume cells");
  access_ = std::make_shared<const FlowAccess>(dataset_, std::move(index), context);
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
  measure_speeds(context);
}

// The largest speed. Infinities, and what is infinite once it is squared, are not velocities: they become NaN.
void FlowField::measure_speeds(Context& context) {
  struct Speeds {
    double largest2 = 0;
    size_t beyond = 0;
  };
  const double most2 = f32_ ? 1e36 : 1e300;
  const Speeds speeds = parallel_reduce(
      packed_.count(), 1 << 15, Speeds(),
      [&](size_t begin, size_t end) {
        const PointVectors v{f32_, f64_, components_};
        Speeds s;
        if (f32_ && components_ == 3) {  // several at a time, for series that come step by step; NaN compares false
          float best[4] = {0, 0, 0, 0};
          const float* p = f32_ + 3 * begin;
          for (size_t i = begin; i + 4 <= end; i += 4, p += 12)
            for (int k = 0; k < 4; ++k) {
              const float e = p[3 * k] * p[3 * k] + p[3 * k + 1] * p[3 * k + 1] + p[3 * k + 2] * p[3 * k + 2];
              best[k] = e > best[k] ? e : best[k];
            }
          for (const float b : best) s.largest2 = std::max(s.largest2, double(b));
          if (s.largest2 <= most2) begin = end - (end - begin) % 4;
          else s.largest2 = 0;
        }
        for (size_t i = begin; i < end; ++i) {
          const Vec3 u = v(i);
          const double e = dot(u, u);
          if (e > most2) ++s.beyond;
          else if (e > s.largest2) s.largest2 = e;
        }
        return s;
      },
      [](Speeds a, Speeds b) {
        return Speeds{std::max(a.largest2, b.largest2), a.beyond + b.beyond};
      });
  largest_speed_ = std::sqrt(speeds.largest2);
  if (speeds.beyond == 0) return;
  context.info(
      fmt::format("{} values of '{}' are infinite or beyond {:g} and count as missing", speeds.beyond, field_.name, std::sqrt(most2)));
  const auto cleared = [&]<class T>(const T* from) {
    T* out = nullptr;
    packed_ = Array::make<T>(packed_.count(), components_, &out);
    for (size_t i = 0; i < packed_.count() * size_t(components_); i += size_t(components_)) {
      double e = 0;
      for (int c = 0; c < components_; ++c) e += double(from[i + size_t(c)]) * double(from[i + size_t(c)]);
      for (int c = 0; c < components_; ++c) out[i + size_t(c)] = e > most2 ? T(NAN) : from[i + size_t(c)];
    }
    return out;
  };
  const Array kept = packed_;  // what is read
  if (f32_) f32_ = cleared(f32_);
  else f64_ = cleared(f64_);
  field_.array = packed_;
}

double FlowField::usual_speed() const {
  const size_t count = packed_.count(), step = std::max<size_t>(1, count / 4096);
  std::vector<double> speeds;
  for (size_t i = 0; i < count; i += step)
    if (const double s = length(at_point(i)); s > 0) speeds.push_back(s);
  if (speeds.empty()) return 0;
  const auto middle = speeds.begin() + ptrdiff_t(speeds.size() / 2);
  std::nth_element(speeds.begin(), middle, speeds.end());
  return *middle;
}

double FlowField::usual_cell() const {
  const double along = std::pow(double(dataset_->cell_count()), 1.0 / dimension_);
  return std::max(dataset_->bounds().diagonal() / std::sqrt(double(dimension_)) / along, std::numeric_limits<double>::min());
}

const std::shared_ptr<const CellLocator>& FlowField::locator() const { return access_->locator(); }

}  // namespace sg
