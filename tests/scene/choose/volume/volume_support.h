// SPDX-License-Identifier: Apache-2.0
// Small volumes with known contents, for tests of looks.
#pragma once
#include <cmath>

#include "data/dataset.h"

namespace sg::test {

/// n^3 points over [-1, 1]^3 with a float point field `name` = f(position).
template <class F>
DatasetPtr cube_of(size_t n, const char* name, F&& f) {
  UniformGrid g;
  g.dims = {n, n, n};
  const double h = 2 / double(n - 1);
  g.origin = {-1, -1, -1}, g.spacing = {h, h, h};
  std::vector<float> v;
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i) v.push_back(float(f(Vec3{-1 + h * double(i), -1 + h * double(j), -1 + h * double(k)})));
  FieldSet fields;
  fields.add({name, Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  return make_dataset(Mesh(g), std::move(fields));
}

/// Two nested balls in air, their borders blurred: 0 outside, 100 within radius 0.8, 300 within 0.45.
inline double nested_balls(Vec3 p) {
  const double r = length(p), blur = 0.06;
  return 50 * std::erfc((r - 0.8) / blur) + 100 * std::erfc((r - 0.45) / blur);
}

}  // namespace sg::test
