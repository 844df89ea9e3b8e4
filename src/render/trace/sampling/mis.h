// SPDX-License-Identifier: Apache-2.0
// Weights of several ways to draw the same thing (Veach 1997). All densities of one sum are in one measure: a density per area of what is
// seen becomes one per solid angle by solid_angle_pdf().
#pragma once
#include <algorithm>

namespace sg::trace {

/// Share of a way that draws n samples with density p where another draws `others` (n times density, summed over the others).
inline float balance_weight(float n_times_p, float others) {
  const float sum = n_times_p + others;
  return sum > 0 ? n_times_p / sum : 0;
}
/// The same with squares, which leaves more to the better way; by their ratio, so that no square overflows.
inline float power_weight(float n_times_p, float others) {
  if (!(n_times_p > 0)) return 0;
  const float ratio = others / n_times_p;
  return 1 / (1 + ratio * ratio);
}
/// Of a density per area at the squared distance, where the line of sight meets the surface with this cosine; infinite edge-on.
inline float solid_angle_pdf(float area_pdf, float distance_squared, float cosine) {
  return area_pdf * distance_squared / std::max(cosine < 0 ? -cosine : cosine, 1e-20f);
}

}  // namespace sg::trace
