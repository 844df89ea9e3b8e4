// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/flow_parts.h"

#include <algorithm>

#include "base/parallel.h"
#include "data/cells/mesh_dimension.h"

namespace sg {

std::vector<DatasetPtr> flow_meshes(const Data& data, std::string& field, std::string_view who) {
  if (std::holds_alternative<TablePtr>(data))
    fail_usage("needs a mesh but got a table", std::string(who), "turn its rows into points first: table_to_points x=... y=... z=...");
  std::vector<DatasetPtr> all;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { all.push_back(d); });
  if (all.empty()) fail_usage("has no mesh as input", std::string(who));
  const auto has = [&](const Dataset& d) {
    if (!field.empty()) return d.fields().find(field) != nullptr;
    return d.fields().with_role(Role::vectors) || d.fields().active(3) || d.fields().active(2);
  };
  int dimension = 0;
  for (const DatasetPtr& d : all)
    if (d->cell_count() > 0 && has(*d)) dimension = std::max(dimension, mesh_dimension(*d));
  std::vector<DatasetPtr> out;
  for (const DatasetPtr& d : all) {
    if (d->cell_count() == 0 || mesh_dimension(*d) != dimension || !has(*d)) continue;
    if (field.empty()) field = flow_field_of(*d, field, who).name;
    out.push_back(d);
  }
  // A single mesh, or the first of many, gives the error.
  if (out.empty()) flow_field_of(*all.front(), field, who), out.push_back(all.front());
  return out;
}

FlowParts::FlowParts(const Data& data, const std::string& field, std::string_view who, Context& context) {
  std::string name = field;
  for (const DatasetPtr& d : flow_meshes(data, name, who)) {
    flow_field_of(*d, name, who);
    fields_.emplace_back(d, name, context);
  }
}

double FlowParts::largest_speed() const {
  double v = 0;
  for (const FlowField& f : fields_) v = std::max(v, f.largest_speed());
  return v;
}

double FlowParts::mean_speed() const {
  using Sum = std::pair<double, double>;
  Sum all{0, 0};
  for (const FlowField& f : fields_) {
    const Sum part = parallel_reduce(
        f.field().array.count(), 1 << 15, Sum{0, 0},
        [&](size_t begin, size_t end) {
          Sum s{0, 0};
          for (size_t i = begin; i < end; ++i) {
            const Vec3 v = f.at_point(i);
            const double e = dot(v, v);
            if (std::isfinite(e)) s.first += e, s.second += 1;
          }
          return s;
        },
        [](Sum a, Sum b) {
          return Sum{a.first + b.first, a.second + b.second};
        });
    all = {all.first + part.first, all.second + part.second};
  }
  return all.second > 0 ? std::sqrt(all.first / all.second) : 0;
}

Box3 FlowParts::bounds() const {
  Box3 b;
  for (const FlowField& f : fields_) b.add(f.dataset()->bounds());
  return b;
}

PartsCursor::PartsCursor(const FlowParts& parts) {
  cursors_.reserve(parts.count());
  for (const FlowField& f : parts.fields()) cursors_.emplace_back(f);
  flat_ = parts.dimension() == 3;
}

bool PartsCursor::operator()(Vec3 x, Vec3& v) {
  if (cursors_[last_](x, v)) return true;
  // Solid parts hold nothing beyond their box; surfaces also answer for points off the surface.
  const auto may_hold = [&](const FlowCursor& c) {
    if (!flat_) return true;
    const Box3& b = c.field().dataset()->bounds();
    const double slack = 1e-6 * b.diagonal();
    for (int a = 0; a < 3; ++a)
      if (!(x[a] >= b.lo[a] - slack && x[a] <= b.hi[a] + slack)) return false;
    return true;
  };
  for (size_t i = 0; i < cursors_.size(); ++i)
    if (i != last_ && may_hold(cursors_[i]) && cursors_[i](x, v)) {
      last_ = i;
      return true;
    }
  return false;
}

bool PartsCursor::gradient(Vec3 x, Vec3& v, Mat3& j) {
  if (cursors_[last_].gradient(x, v, j)) return true;
  return (*this)(x, v) && cursors_[last_].gradient(x, v, j);
}

Vec3 PartsCursor::snap(Vec3 x) {
  if (flat_) return x;
  Vec3 at;
  if (cursors_[last_].snap(x, at)) return at;
  for (FlowCursor& c : cursors_)
    if (c.snap(x, at)) return at;
  return x;
}

}  // namespace sg
