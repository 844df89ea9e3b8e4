// SPDX-License-Identifier: Apache-2.0
// What a test of samples needs: chi-square with pooled bins, means with their standard errors.
#pragma once
#include <cmath>
#include <vector>

namespace sg::test {

/// Mean and variance of what is added, one value after the other (Welford 1962).
struct Moments {
  double n = 0, mean = 0, squares = 0;
  void add(double v) {
    n += 1;
    const double d = v - mean;
    mean += d / n, squares += d * (v - mean);
  }
  double variance() const { return squares / (n - 1); }
  double standard_error() const { return std::sqrt(variance() / n); }
};

/// The chance that a chi-square sum of so many degrees of freedom is above `sum`: Q(freedom / 2, sum / 2), the regularised incomplete
/// gamma function by its series or its continued fraction.
inline double chi_square_tail(double sum, double freedom) {
  const double a = freedom / 2, x = sum / 2;
  if (!(x > 0)) return 1;
  const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a, total = term;
    for (int n = 1; n < 10000 && term > total * 1e-15; ++n) term *= x / (a + n), total += term;
    return 1 - front * total;
  }
  double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
  for (int i = 1; i < 10000; ++i) {
    const double an = -i * (i - a);
    b += 2, d = 1 / (an * d + b), c = b + an / c;
    h *= d * c;
    if (std::abs(d * c - 1) < 1e-15) break;
  }
  return front * h;
}

/// The chance of bins at least as far from the expected counts. Bins that expect less than five are pooled; a count where none is
/// expected is 0.
inline double chi_square_chance(const std::vector<double>& observed, const std::vector<double>& expected) {
  double sum = 0, freedom = -1, pooled = 0, pooled_expected = 0;
  for (size_t i = 0; i < expected.size(); ++i) {
    if (expected[i] <= 0 && observed[i] > 0) return 0;
    if (expected[i] < 5) pooled += observed[i], pooled_expected += expected[i];
    else sum += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i], ++freedom;
  }
  if (pooled_expected >= 5) sum += (pooled - pooled_expected) * (pooled - pooled_expected) / pooled_expected, ++freedom;
  return freedom < 1 ? 1 : chi_square_tail(sum, freedom);
}

}  // namespace sg::test
