// SPDX-License-Identifier: Apache-2.0
#include "simulate/mechanics/solve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace sg::mechanics {

int solve(std::vector<double> a, std::vector<double>& b) {
  const size_t n = b.size();
  // By rows, then by columns: coordinates may be of any unit.
  std::vector<double> column(n, 0);
  for (size_t i = 0; i < n; ++i) {
    double most = 0;
    for (size_t j = 0; j < n; ++j) most = std::max(most, std::abs(a[i * n + j]));
    if (!(most > 0) || !std::isfinite(most)) return int(i);
    for (size_t j = 0; j < n; ++j) a[i * n + j] /= most;
    b[i] /= most;
  }
  for (size_t j = 0; j < n; ++j) {
    for (size_t i = 0; i < n; ++i) column[j] = std::max(column[j], std::abs(a[i * n + j]));
    if (!(column[j] > 0)) return int(j);
    for (size_t i = 0; i < n; ++i) a[i * n + j] /= column[j];
  }
  for (size_t k = 0; k < n; ++k) {
    size_t best = k;
    for (size_t i = k + 1; i < n; ++i)
      if (std::abs(a[i * n + k]) > std::abs(a[best * n + k])) best = i;
    if (!(std::abs(a[best * n + k]) > 1e-14 * double(n))) return int(k);
    if (best != k) {
      for (size_t j = 0; j < n; ++j) std::swap(a[k * n + j], a[best * n + j]);
      std::swap(b[k], b[best]);
    }
    for (size_t i = k + 1; i < n; ++i) {
      const double f = a[i * n + k] / a[k * n + k];
      if (f == 0) continue;
      for (size_t j = k; j < n; ++j) a[i * n + j] -= f * a[k * n + j];
      b[i] -= f * b[k];
    }
  }
  for (size_t k = n; k-- > 0;) {
    for (size_t j = k + 1; j < n; ++j) b[k] -= a[k * n + j] * b[j];
    b[k] /= a[k * n + k];
  }
  for (size_t j = 0; j < n; ++j) b[j] /= column[j];
  return -1;
}

}  // namespace sg::mechanics
