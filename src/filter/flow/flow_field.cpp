// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/flow_field.h"

#include "base/parallel.h"
#include "data/mesh_dimension.h"
#include "filter/field/point_cell.h"
#include "filter/flow/flow_access.h"

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
  dimension_ = mesh_dimension(*dataset_);
  if (dataset_->cell_count() == 0 || dimension_ < 1)
    fail_usage(fmt::format("there is no flow between the points of a mesh of {} with {} cells", dataset_->kind(), dataset_->cell_count()),
               "flow", "a grid, or cells of lines, surfaces or volume");
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
  const size_t count = packed_.count();
  // NaN compares false, and infinities are no speeds.
  const double largest2 = parallel_reduce(
      count, 1 << 15, 0.0,
      [&](size_t begin, size_t end) {
        const PointVectors v{f32_, f64_, components_};
        double most = 0;
        if (f32_ && components_ == 3) {  // several at a time, for series that come step by step
          float best[4] = {0, 0, 0, 0};
          const float* p = f32_ + 3 * begin;
          for (size_t i = begin; i + 4 <= end; i += 4, p += 12)
            for (int k = 0; k < 4; ++k) {
              const float e = p[3 * k] * p[3 * k] + p[3 * k + 1] * p[3 * k + 1] + p[3 * k + 2] * p[3 * k + 2];
              best[k] = e > best[k] ? e : best[k];
            }
          for (const float b : best) most = std::max(most, double(b));
          if (most < HUGE_VAL) begin = end - (end - begin) % 4;
          else most = 0;  // an infinity among them
        }
        for (size_t i = begin; i < end; ++i) {
          const Vec3 u = v(i);
          const double e = dot(u, u);
          most = e > most && e < HUGE_VAL ? e : most;
        }
        return most;
      },
      [](double a, double b) { return std::max(a, b); });
  largest_speed_ = std::sqrt(largest2);
}

const std::shared_ptr<const CellLocator>& FlowField::locator() const { return access_->locator(); }

}  // namespace sg
