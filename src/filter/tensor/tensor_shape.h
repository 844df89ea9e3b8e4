// SPDX-License-Identifier: Apache-2.0
// Measures of a tensor's shape from its eigenvalues, in descending order: l[0] >= l[1] >= l[2].
#pragma once
#include <algorithm>
#include <cmath>

#include "filter/tensor/sym_tensor.h"

namespace sg {

inline double mean_of(const double* l) { return (l[0] + l[1] + l[2]) / 3; }
inline double norm_of(const double* l) {
  const double m = std::max(std::abs(l[0]), std::abs(l[2]));
  if (!(m > 0)) return m;
  const double a = l[0] / m, b = l[1] / m, c = l[2] / m;
  return m * std::sqrt(a * a + b * b + c * c);
}
/// Length of the deviator: sqrt of the sum of squared distances from the mean, from differences so that nothing cancels.
inline double deviation_of(const double* l) {
  const double d[3] = {l[0] - l[1], l[1] - l[2], l[0] - l[2]};
  const double m = std::abs(d[2]);
  if (!(m > 0)) return m;
  const double a = d[0] / m, b = d[1] / m;
  return m * std::sqrt((a * a + b * b + 1) / 3);
}

/// Fractional anisotropy sqrt(3/2) |D - MD I| / |D| = sqrt(1/2) sqrt(sum of squared differences) / |D| (Basser, Pierpaoli 1996): 0 for
/// a sphere, 1 for a line; above 1 only with negative eigenvalues. 0 for the zero tensor.
inline double fractional_anisotropy(const double* l) {
  const double n = norm_of(l);
  return n == 0 ? 0 : std::sqrt(1.5) * (deviation_of(l) / n);
}
/// In the plane: |l1 - l2| / sqrt(l1^2 + l2^2).
inline double fractional_anisotropy_2d(const double* l) {
  const double n = std::hypot(l[0], l[1]);
  return n == 0 ? 0 : (l[0] - l[1]) / n;
}
/// Relative anisotropy |D - MD I| / (sqrt(3) MD): 0 .. sqrt(2). 0 for the zero tensor.
inline double relative_anisotropy(const double* l) {
  const double d = deviation_of(l);
  return d == 0 ? 0 : d / (std::sqrt(3.0) * mean_of(l));
}
/// 3 sqrt(6) det(A/|A|) of the deviator A (Ennis, Kindlmann 2006): 1 for a line, 0 orthotropic, -1 for a disc. NaN where the deviator
/// is below 1e-13 of the tensor: there is none.
inline double tensor_mode(const double* l) {
  const double d = deviation_of(l);
  if (!(d > 1e-13 * norm_of(l))) return NAN;
  // Deviatoric values from differences.
  const double a = ((l[0] - l[1]) + (l[0] - l[2])) / (3 * d), b = ((l[1] - l[0]) + (l[1] - l[2])) / (3 * d),
               c = ((l[2] - l[0]) + (l[2] - l[1])) / (3 * d);
  return std::clamp(3 * std::sqrt(6.0) * a * b * c, -1.0, 1.0);
}

struct Westin {
  double linear, planar, spherical;
};
/// Sum to 1. By the trace: (l1-l2)/t, 2(l2-l3)/t, 3 l3/t (Westin et al. 1997); by the largest: (l1-l2)/l1, (l2-l3)/l1, l3/l1 (Westin et
/// al. 2002). NaN for the zero tensor.
inline Westin westin_of(const double* l, bool by_trace) {
  const double t = by_trace ? l[0] + l[1] + l[2] : l[0];
  return {(l[0] - l[1]) / t, (by_trace ? 2 : 1) * (l[1] - l[2]) / t, (by_trace ? 3 : 1) * l[2] / t};
}

inline double von_mises_of(const double* l) { return std::sqrt(1.5) * deviation_of(l); }

}  // namespace sg
