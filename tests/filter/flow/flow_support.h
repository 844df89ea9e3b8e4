// SPDX-License-Identifier: Apache-2.0
// Velocities that are functions of position, on the points of meshes.
#pragma once
#include <vector>

#include "data/cells/point_positions.h"
#include "data/dataset.h"

namespace sg::test {

/// f(position) at each point of a mesh: the first `components` of its three.
template <class T = double, class F>
Array at_points(const Mesh& mesh, F&& f, int components = 3) {
  const Array at = point_positions(mesh);
  std::vector<T> v;
  v.reserve(at.count() * size_t(components));
  for (size_t i = 0; i < at.count(); ++i) {
    const Vec3 u = f(Vec3(at.get(i, 0), at.get(i, 1), at.get(i, 2)));
    for (int c = 0; c < components; ++c) v.push_back(T(u[c]));
  }
  return Array::from_vector(std::move(v), components);
}

/// About the z axis, one radian in a unit of time.
inline Vec3 rotation(Vec3 p) { return {-p.y, p.x, 0}; }

/// The mesh with the point field "velocity" alone.
template <class T = double, class F>
DatasetPtr velocity_on(const Mesh& mesh, F&& f) {
  FieldSet fields;
  fields.add({"velocity", Association::point, at_points<T>(mesh, f), "", Role::vectors});
  return make_dataset(mesh, std::move(fields));
}

/// The same data at each of the times.
inline Series steady_series(const Data& d, std::vector<double> times = {0}) {
  return {std::move(times), [=](size_t) -> Data { return d; }};
}

/// dims points, the first at lo, the same distance along each axis.
inline UniformGrid even_grid(std::array<size_t, 3> dims, Vec3 lo, double spacing) {
  UniformGrid g;
  g.dims = dims, g.origin = lo, g.spacing = {spacing, spacing, spacing};
  return g;
}

/// The velocity in the cube [lo, hi]^3 with n points a side.
template <class F>
DatasetPtr cube_flow(size_t n, double lo, double hi, F&& f) {
  return velocity_on(even_grid({n, n, n}, {lo, lo, lo}, (hi - lo) / double(n - 1)), f);
}

}  // namespace sg::test
