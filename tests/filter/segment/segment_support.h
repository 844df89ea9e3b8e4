// SPDX-License-Identifier: Apache-2.0
// Small images for the tests of segmentation.
#pragma once
#include <cstring>
#include <functional>

#include "base/parallel.h"
#include "data/dataset.h"
#include "support/test.h"

namespace sg::test {

template <class T>
DatasetPtr image_of(std::array<size_t, 3> d, const std::function<double(Vec3)>& f, Vec3 spacing = {1, 1, 1}, Role role = Role::scalars) {
  UniformGrid g;
  g.dims = d, g.spacing = spacing;
  std::vector<T> v(d[0] * d[1] * d[2]);
  for (size_t i = 0; i < v.size(); ++i) v[i] = T(f(spacing * Vec3(double(i % d[0]), double(i / d[0] % d[1]), double(i / (d[0] * d[1])))));
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::move(v)), "", role});
  return make_dataset(g, std::move(fields));
}

inline const Array& array_of(const DatasetPtr& d, const std::string& name) { return d->fields().require(name).array; }

/// Runs f with one thread and with eight; true when the named field has the same bytes.
inline bool same_for_threads(const std::string& name, const std::function<DatasetPtr()>& f) {
  set_thread_count(8);
  const DatasetPtr many = f();
  set_thread_count(1);
  const DatasetPtr one = f();
  set_thread_count(0);
  const Array &a = array_of(many, name), &b = array_of(one, name);
  return a.bytes() == b.bytes() && std::memcmp(a.raw(), b.raw(), a.bytes()) == 0;
}

/// The same dataset with NaN-free hidden points: those where f says so.
inline DatasetPtr with_hidden_points(const DatasetPtr& d, const std::function<bool(size_t)>& f) {
  std::vector<uint8_t> ghost(d->point_count(), 0);
  for (size_t i = 0; i < ghost.size(); ++i)
    if (f(i)) ghost[i] = ghost_hidden_point;
  DatasetParts parts = d->parts();
  parts.point_ghost = Array::from_vector(std::move(ghost));
  return make_dataset(std::move(parts));
}

}  // namespace sg::test
