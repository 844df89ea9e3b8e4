// SPDX-License-Identifier: Apache-2.0
// What the tensor tests share: tensors with known parts, meshes that carry a tensor function.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "filter/cell_meshes.h"
#include "filter/tensor/sym_tensor.h"
#include "support/test.h"

namespace sg::test {

/// A rotation by random angles.
inline Mat3 random_rotation(uint64_t seed) {
  const double u = random_unit(seed, 0), a = 2 * M_PI * random_unit(seed, 1), b = 2 * M_PI * random_unit(seed, 2);
  const double x = std::sqrt(1 - u) * std::sin(a), y = std::sqrt(1 - u) * std::cos(a), z = std::sqrt(u) * std::sin(b),
               w = std::sqrt(u) * std::cos(b);
  Mat3 r;
  const double m[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                          {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                          {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
  std::memcpy(r.m, m, sizeof m);
  return r;
}

inline SymTensor diagonal(double a, double b, double c) { return {a, b, c, 0, 0, 0}; }

/// One tensor for all places.
inline const SymTensor constant = rotated(diagonal(4, 2, 1), random_rotation(11));

inline double value(const DatasetPtr& d, const std::string& field, size_t i = 0, int c = 0) {
  return d->fields().require(field).array.get(i, c);
}
/// A point of a cloud or a surface.
inline Vec3 point(const DatasetPtr& d, size_t i) {
  if (auto* cloud = d->as<PointCloud>()) return cloud->points.at(i);
  return d->as<SurfaceMesh>()->points.at(i);
}

inline Field tensor_field(const std::vector<SymTensor>& d, Association a = Association::point, std::string name = "tensor") {
  std::vector<double> v;
  for (const SymTensor& t : d) v.insert(v.end(), {t.xx, t.xy, t.xz, t.xy, t.yy, t.yz, t.xz, t.yz, t.zz});
  return {std::move(name), a, Array::from_vector(std::move(v), 9), "", Role::tensors};
}

/// Points at (i, 0, 0) with these tensors.
inline DatasetPtr tensor_points(const std::vector<SymTensor>& d) {
  PointCloud cloud;
  std::vector<double> xyz;
  for (size_t i = 0; i < d.size(); ++i) xyz.insert(xyz.end(), {double(i), 0, 0});
  cloud.points.xyz = Array::from_vector(std::move(xyz), 3);
  FieldSet fields;
  fields.add(tensor_field(d));
  return make_dataset(cloud, fields);
}

/// [lo,hi] with n points an axis.
template <class F>
DatasetPtr tensor_grid(std::array<size_t, 3> n, Vec3 lo, Vec3 hi, F&& f) {
  UniformGrid g;
  g.dims = n, g.origin = lo;
  for (int a = 0; a < 3; ++a) g.spacing[a] = n[size_t(a)] > 1 ? (hi[a] - lo[a]) / double(n[size_t(a)] - 1) : 1;
  std::vector<SymTensor> d;
  for (size_t k = 0; k < n[2]; ++k)
    for (size_t j = 0; j < n[1]; ++j)
      for (size_t i = 0; i < n[0]; ++i) d.push_back(f(g.origin + g.spacing * Vec3(double(i), double(j), double(k))));
  FieldSet fields;
  fields.add(tensor_field(d));
  return make_dataset(g, fields);
}

/// The mesh of `d` with the tensor function at its points.
template <class F>
DatasetPtr with_tensors(const DatasetPtr& d, F&& f, const std::vector<Vec3>& at) {
  DatasetParts parts = d->parts();
  std::vector<SymTensor> t;
  for (Vec3 p : at) t.push_back(f(p));
  parts.fields = {};
  parts.fields.add(tensor_field(t));
  return make_dataset(std::move(parts));
}

inline std::vector<Vec3> places(const Array& xyz) {
  std::vector<Vec3> r;
  for (size_t i = 0; i < xyz.count(); ++i) r.push_back({xyz.get(i, 0), xyz.get(i, 1), xyz.get(i, 2)});
  return r;
}

inline bool equal_bytes(const Array& a, const Array& b) {
  const Array p = a.made_packed(), q = b.made_packed();
  return p.count() == q.count() && p.type() == q.type() && p.components() == q.components() &&
         (p.bytes() == 0 || std::memcmp(p.raw(), q.raw(), p.bytes()) == 0);
}
inline bool equal_fields(const Dataset& a, const Dataset& b) {
  bool same = a.fields().size() == b.fields().size();
  for (size_t i = 0; same && i < a.fields().size(); ++i)
    same = a.fields()[i].name == b.fields()[i].name && equal_bytes(a.fields()[i].array, b.fields()[i].array);
  return same;
}

/// Runs f with 1 and with 8 threads and gives both results.
template <class F>
auto with_threads(F&& f) {
  set_thread_count(1);
  auto one = f();
  set_thread_count(8);
  auto eight = f();
  set_thread_count(0);
  return std::pair(one, eight);
}

/// A context that keeps what it is told.
struct Listener {
  Context context;
  std::string warnings, notes;
  Listener() {
    context.on_log = [this](LogLevel level, std::string_view text) {
      (level == LogLevel::warning ? warnings : notes) += std::string(text) + "\n";
    };
  }
};

}  // namespace sg::test
