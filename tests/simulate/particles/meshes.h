// SPDX-License-Identifier: Apache-2.0
// Small meshes for tests of particles.
#pragma once
#include <vector>

#include "data/dataset.h"

namespace sg::test {

inline DatasetPtr triangles(const std::vector<Vec3>& points, const std::vector<int64_t>& ids) {
  std::vector<double> xyz;
  for (const Vec3& p : points)
    for (int a = 0; a < 3; ++a) xyz.push_back(p[a]);
  SurfaceMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.polygons.connectivity = Array::from_vector(ids), mesh.polygons.fixed = 3;
  return make_dataset(std::move(mesh));
}

/// An octahedron whose triangles were split `times` times, blown up to a ball of radius 1.
inline DatasetPtr ball(int times) {
  std::vector<Vec3> p{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<int64_t> t{0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  for (int k = 0; k < times; ++k) {
    std::vector<int64_t> next;
    const auto middle = [&](int64_t a, int64_t b) -> int64_t {
      const Vec3 m = normalize(p[size_t(a)] + p[size_t(b)]);
      for (size_t i = 0; i < p.size(); ++i)
        if (length(p[i] - m) < 1e-12) return int64_t(i);
      p.push_back(m);
      return int64_t(p.size()) - 1;
    };
    for (size_t i = 0; i < t.size(); i += 3) {
      const int64_t a = t[i], b = t[i + 1], c = t[i + 2], ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const int64_t v : {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca}) next.push_back(v);
    }
    t = next;
  }
  return triangles(p, t);
}

inline DatasetPtr box(Vec3 lo, Vec3 hi) {
  std::vector<Vec3> p;
  for (int i = 0; i < 8; ++i) p.emplace_back(i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z);
  return triangles(p, {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5});
}

/// A grid over [-1, 1]^3 with the point field "velocity", from f(place).
template <class F>
DatasetPtr wind(size_t n, F&& f) {
  UniformGrid g;
  g.dims = {n, n, n}, g.origin = {-1, -1, -1};
  g.spacing = Vec3(1, 1, 1) * (2.0 / double(n - 1));
  std::vector<float> v;
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i) {
        const Vec3 u = f(g.origin + g.spacing * Vec3(double(i), double(j), double(k)));
        for (int a = 0; a < 3; ++a) v.push_back(float(u[a]));
      }
  FieldSet fields;
  fields.add({"velocity", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
  return make_dataset(g, std::move(fields));
}

}  // namespace sg::test
