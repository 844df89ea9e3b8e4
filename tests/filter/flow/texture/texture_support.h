// SPDX-License-Identifier: Apache-2.0
// Flows on grids of pixels, and statistics of textures.
#pragma once
#include <cstring>

#include "base/parallel.h"
#include "data/dataset.h"
#include "support/test.h"

namespace sg::test {

/// n x m pixels of size 1 with the vectors f(x, y, out).
template <class F>
DatasetPtr flow_2d(size_t n, size_t m, F&& f, int components = 3) {
  UniformGrid g;
  g.dims = {n, m, 1};
  std::vector<float> v;
  for (size_t j = 0; j < m; ++j)
    for (size_t i = 0; i < n; ++i) {
      float u[3] = {0, 0, 0};
      f(double(i), double(j), u);
      v.insert(v.end(), u, u + components);
    }
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::move(v), components), "", Role::vectors});
  return make_dataset(g, fields);
}

inline DatasetPtr rotation(size_t n) {
  const double c = double(n - 1) / 2;
  return flow_2d(n, n, [c](double x, double y, float* u) { u[0] = float(c - y), u[1] = float(x - c); });
}

inline std::vector<float> values_of(const DatasetPtr& d, const char* name) {
  const Array& a = d->fields().require(name, Association::point).array;
  const float* p = a.view<float>().data;
  return {p, p + a.count() * size_t(a.components())};
}

/// Variance and correlations of the part of an n x m picture that is `margin` away from its border.
struct Statistics {
  const std::vector<float>& v;
  size_t n, m, margin;
  double mean() const {
    double s = 0, k = 0;
    each([&](size_t i, size_t j) { s += at(i, j), k += 1; });
    return s / k;
  }
  double covariance(size_t di, size_t dj) const {
    const double mu = mean();
    double s = 0, k = 0;
    for (size_t j = margin; j + dj + margin < m; ++j)
      for (size_t i = margin; i + di + margin < n; ++i) s += (at(i, j) - mu) * (at(i + di, j + dj) - mu), k += 1;
    return s / k;
  }
  double correlation(size_t di, size_t dj) const { return covariance(di, dj) / covariance(0, 0); }
  double at(size_t i, size_t j) const { return double(v[i + n * j]); }
  template <class F>
  void each(F&& f) const {
    for (size_t j = margin; j + margin < m; ++j)
      for (size_t i = margin; i + margin < n; ++i) f(i, j);
  }
};

inline double correlation_of(const std::vector<float>& a, const std::vector<float>& b) {
  double sa = 0, sb = 0, n = 0;
  for (size_t i = 0; i < a.size(); ++i)
    if (a[i] == a[i] && b[i] == b[i]) sa += double(a[i]), sb += double(b[i]), n += 1;
  sa /= n, sb /= n;
  double ab = 0, aa = 0, bb = 0;
  for (size_t i = 0; i < a.size(); ++i)
    if (a[i] == a[i] && b[i] == b[i]) {
      const double x = double(a[i]) - sa, y = double(b[i]) - sb;
      ab += x * y, aa += x * x, bb += y * y;
    }
  return ab / std::sqrt(aa * bb);
}

inline bool same_bytes(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

}  // namespace sg::test
