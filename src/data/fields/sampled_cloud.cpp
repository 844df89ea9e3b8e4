// SPDX-License-Identifier: Apache-2.0
#include "data/fields/sampled_cloud.h"

#include <algorithm>
#include <cmath>

#include "data/field_ops.h"

namespace sg {

namespace {

// Tuples that are neither hidden nor ghosts.
std::vector<int64_t> seen_tuples(const Array& ghosts, size_t count, size_t most) {
  std::vector<int64_t> ids;
  if (most == 0) return ids;
  const size_t step = std::max<size_t>(1, (count + most - 1) / most);
  for (size_t i = 0; i < count; i += step)
    if (ghosts.count() == 0 || ghosts.get(i) == 0) ids.push_back(int64_t(i));
  return ids;
}

// Where each component and the magnitude are least and greatest.
std::vector<int64_t> extremes(const Array& values, const Array& ghosts) {
  std::vector<int64_t> ids;
  dispatch(values, [&](auto v) {
    const int measures = v.components > 1 ? v.components + 1 : 1;
    std::vector<double> least(size_t(measures), HUGE_VAL), greatest(size_t(measures), -HUGE_VAL);
    std::vector<int64_t> at(2 * size_t(measures), -1);
    for (size_t i = 0; i < v.count; ++i) {
      if (ghosts.count() > 0 && ghosts.get(i) != 0) continue;
      double squares = 0;
      for (int m = 0; m < measures; ++m) {
        const double x = m < v.components ? double(v(i, m)) : squares;
        squares += x * x;
        if (!std::isfinite(x)) continue;
        if (x < least[size_t(m)]) least[size_t(m)] = x, at[2 * size_t(m)] = int64_t(i);
        if (x > greatest[size_t(m)]) greatest[size_t(m)] = x, at[2 * size_t(m) + 1] = int64_t(i);
      }
    }
    for (const int64_t i : at)
      if (i >= 0) ids.push_back(i);
  });
  return ids;
}

}  // namespace

DatasetPtr sampled_cloud(const Dataset& data, size_t most) {
  std::vector<std::pair<const Field*, std::vector<int64_t>>> kept;
  FieldSet fields;
  size_t count = 0;
  for (const Field& f : data.fields()) {
    const bool twice = f.association == Association::cell && data.fields().find(f.name, Association::point);
    if (f.association == Association::whole) fields.add(f);
    if (f.association == Association::whole || twice || f.array.count() == 0) continue;
    const Array& ghosts = f.association == Association::point ? data.point_ghost() : data.cell_ghost();
    std::vector<int64_t> ids = extremes(f.array, ghosts), others = seen_tuples(ghosts, f.array.count(), most);
    ids.insert(ids.end(), others.begin(), others.end());
    count = std::max(count, ids.size());
    kept.emplace_back(&f, std::move(ids));
  }
  const Box3 box = data.bounds();
  if (box.empty()) count = 0;
  else count = std::max<size_t>(count, 2);
  for (auto& [field, ids] : kept) {
    if (ids.empty()) continue;  // nothing of it is seen
    const std::vector<int64_t> own = ids;
    while (ids.size() < count) ids.insert(ids.end(), own.begin(), own.begin() + ptrdiff_t(std::min(own.size(), count - ids.size())));
    ids.resize(count);
    Field f = *field;
    f.association = Association::point, f.array = gather(field->array, ids);
    fields.add(std::move(f));
  }
  std::vector<double> xyz;
  for (size_t i = 0; i < count; ++i)
    for (int a = 0; a < 3; ++a) xyz.push_back(i == 1 ? box.hi[a] : box.lo[a]);
  DatasetParts parts;
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::move(xyz), 3);
  parts.mesh = std::move(cloud);
  parts.fields = std::move(fields);
  parts.notes = data.notes();
  parts.time = data.time();
  return make_dataset(std::move(parts));
}

}  // namespace sg
