// SPDX-License-Identifier: Apache-2.0
#include "io/mfem/polynomials.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace sg::mfem {

std::pair<double, double> legendre(int n, double x) {
  double p0 = 1, p1 = x;
  if (n == 0) return {1, 0};
  for (int k = 2; k <= n; ++k) {
    const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
    p0 = p1, p1 = p2;
  }
  const double d = x * x == 1 ? (x > 0 || n % 2 ? 1 : -1) * n * (n + 1) / 2.0 : n * (x * p1 - p0) / (x * x - 1);
  return {p1, d};
}

void solve(std::vector<double>& a, std::vector<double>& b, size_t n, size_t columns) {
  for (size_t k = 0; k < n; ++k) {
    size_t pivot = k;
    for (size_t i = k + 1; i < n; ++i)
      if (std::fabs(a[i * n + k]) > std::fabs(a[pivot * n + k])) pivot = i;
    if (a[pivot * n + k] == 0) fail_internal("mfem: the nodes of an element do not determine its polynomials");
    if (pivot != k) {
      std::swap_ranges(a.begin() + ptrdiff_t(k * n), a.begin() + ptrdiff_t(k * n + n), a.begin() + ptrdiff_t(pivot * n));
      std::swap_ranges(b.begin() + ptrdiff_t(k * columns), b.begin() + ptrdiff_t(k * columns + columns),
                       b.begin() + ptrdiff_t(pivot * columns));
    }
    for (size_t i = k + 1; i < n; ++i) {
      const double f = a[i * n + k] / a[k * n + k];
      if (f == 0) continue;
      for (size_t j = k; j < n; ++j) a[i * n + j] -= f * a[k * n + j];
      for (size_t j = 0; j < columns; ++j) b[i * columns + j] -= f * b[k * columns + j];
    }
  }
  for (size_t k = n; k-- > 0;)
    for (size_t j = 0; j < columns; ++j) {
      double sum = b[k * columns + j];
      for (size_t i = k + 1; i < n; ++i) sum -= a[k * n + i] * b[i * columns + j];
      b[k * columns + j] = sum / a[k * n + k];
    }
}

}  // namespace sg::mfem
