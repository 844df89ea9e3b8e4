// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/flow_parts.h"

#include "base/parallel.h"

namespace sg {

FlowParts::FlowParts(const Data& data, const std::string& field, std::string_view who, Context& context) {
  if (std::holds_alternative<TablePtr>(data))
    fail_usage("needs a mesh but got a table", std::string(who), "make points of its rows first: table_to_points x=... y=... z=...");
  std::vector<DatasetPtr> all;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { all.push_back(d); });
  if (all.empty()) fail_usage("got no mesh", std::string(who));
  std::string name = field;
  int dimension = 0;
  std::vector<FlowField> made;
  for (const DatasetPtr& d : all) {
    // A lone mesh, and the last hope of a collection, tell what is wrong.
    const bool must = made.empty() && &d == &all.back();
    if (!must && (d->cell_count() == 0 || (!name.empty() && !d->fields().find(name)))) continue;
    if (!must && name.empty() && !d->fields().with_role(Role::vectors) && !d->fields().active(3) && !d->fields().active(2)) continue;
    const Field& f = flow_field_of(*d, name, who);
    if (name.empty()) name = f.name;
    made.emplace_back(d, name, context);
    dimension = std::max(dimension, made.back().dimension());
  }
  for (FlowField& f : made)
    if (f.dimension() == dimension) fields_.push_back(std::move(f));
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
  for (size_t i = 0; i < cursors_.size(); ++i)
    if (i != last_ && cursors_[i](x, v)) {
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
