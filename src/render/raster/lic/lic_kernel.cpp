// SPDX-License-Identifier: Apache-2.0
#include "render/raster/lic/lic_kernel.h"

#include <algorithm>
#include <cmath>

namespace sg::raster {

LicWeights lic_weights(const SurfaceTexture& t, double grain) {
  constexpr double two_pi = 6.283185307179586;
  const int n = t.steps;
  LicWeights r;
  r.steps = n;
  r.weight.resize(size_t(2 * n + 1));
  for (int k = -n; k <= n; ++k) {
    double w = t.kernel == LicKernel::hann ? 0.5 + 0.5 * std::cos(two_pi * k / (2 * n + 2)) : 1.0;
    if (t.phase) w *= 0.5 + 0.5 * std::cos(two_pi * (4.0 * k / (2 * n + 1) - *t.phase));
    r.weight[size_t(n + k)] = float(w);
  }
  // variance[b][f] grows by one sample at an end: its own square and its products with those that share its grain.
  const int reach = int(std::ceil(std::max(grain, 1.0))) - 1;
  const auto joined = [&](int k, int from, int to) {
    const double w = double(r.weight[size_t(n + k)]);
    double sum = w * w;
    for (int j = std::max(from, k - reach); j <= std::min(to, k + reach); ++j)
      if (j != k) sum += 2 * w * double(r.weight[size_t(n + j)]) * std::max(0.0, 1 - std::abs(j - k) / grain);
    return sum;
  };
  r.factor.resize(size_t(n + 1) * size_t(n + 1));
  double first = joined(0, 0, 0);
  for (int b = 0; b <= n; ++b) {
    if (b > 0) first += joined(-b, -b, 0);
    double variance = first;
    for (int f = 0; f <= n; ++f) {
      if (f > 0) variance += joined(f, -b, f);
      r.factor[size_t(b) * size_t(n + 1) + size_t(f)] = variance > 1e-12 ? float(1 / std::sqrt(variance / 12)) : 0.0f;
    }
  }
  return r;
}

}  // namespace sg::raster
