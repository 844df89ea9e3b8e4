// SPDX-License-Identifier: Apache-2.0
// Where scattered light goes in matter without a surface: densities per solid angle of the cosine between the directions in which light
// travels before and after: 1 is straight on. (Of directions that both point away from the point, as a Bsdf has them, it is the other
// sign.)
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

namespace sg {

/// Henyey and Greenstein (1941): mean cosine g, -1 < g < 1.
inline float henyey_greenstein(float cosine, float g) {
  const float d = std::max(1 + g * g - 2 * g * cosine, 1e-12f);
  return (1 - g * g) / (4 * std::numbers::pi_v<float> * d * std::sqrt(d));
}
/// A cosine drawn from it, for u in [0, 1).
inline float sample_henyey_greenstein(float g, float u) {
  if (std::abs(g) < 1e-3f)
    return 2 * u - 1 + 1.5f * g * (1 - (2 * u - 1) * (2 * u - 1));  // to second order in g, where the closed form cancels
  const float s = (1 - g * g) / (1 - g + 2 * g * u);
  return std::clamp((1 + g * g - s * s) / (2 * g), -1.f, 1.f);
}

/// Particles much smaller than the wavelength.
inline float rayleigh(float cosine) { return 3 / (16 * std::numbers::pi_v<float>)*(1 + cosine * cosine); }
/// The root of a cubic: u = (c^3 + 3 c + 4) / 8.
inline float sample_rayleigh(float u) {
  const float half = 4 * u - 2, root = std::cbrt(half + std::sqrt(half * half + 1));
  return std::clamp(root - 1 / root, -1.f, 1.f);
}

}  // namespace sg
