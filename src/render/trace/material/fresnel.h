// SPDX-License-Identifier: Apache-2.0
// What smooth boundaries reflect: shares of power, from 0 to 1, for a cosine of incidence from 0 to 1.
#pragma once
#include <algorithm>
#include <cmath>

#include "base/vec.h"

namespace sg::trace {

/// At a boundary of transparent matter.
struct Fresnel {
  float s = 1, p = 1;                              ///< of light that swings across the plane of incidence, and in it
  float cosine_through = 0;                        ///< of the refracted direction to the normal; 0 where all is reflected
  float reflected() const { return (s + p) / 2; }  ///< of unpolarised light
};

/// `eta`: the index of refraction beyond the boundary, by that on this side. Total reflection where sin > eta.
inline Fresnel fresnel_dielectric(float cosine, float eta) {
  if (eta == 1) return {0, 0, cosine};
  const float sine2 = std::max(0.f, 1 - cosine * cosine) / (eta * eta);
  if (sine2 >= 1) return {};
  const float through = std::sqrt(1 - sine2);
  const float s = (cosine - eta * through) / (cosine + eta * through), p = (eta * cosine - through) / (eta * cosine + through);
  return {s * s, p * p, through};
}

/// Of metals: unpolarised light from outside, index of refraction eta - i k relative to the outside (Born, Wolf, section 14.2).
inline float fresnel_conductor(float cosine, float eta, float k) {
  const float c2 = cosine * cosine, s2 = std::max(0.f, 1 - c2);
  const float t = eta * eta - k * k - s2, a2b2 = std::sqrt(t * t + 4 * eta * eta * k * k), a = std::sqrt(std::max(0.f, (a2b2 + t) / 2));
  const float s = (a2b2 + c2 - 2 * cosine * a) / (a2b2 + c2 + 2 * cosine * a);
  const float sum = c2 * a2b2 + s2 * s2, cross = 2 * cosine * a * s2;
  const float p = sum + cross > 0 ? s * (sum - cross) / (sum + cross) : 1;
  return (s + p) / 2;
}

/// Schlick's approximation (1994): the reflectance at normal incidence, rising to 1.
inline float schlick_share(float cosine) {
  const float c = std::clamp(1 - cosine, 0.f, 1.f), c2 = c * c;
  return c2 * c2 * c;
}
inline Vec3f fresnel_schlick(float cosine, Vec3f normal) { return normal + (Vec3f(1, 1, 1) - normal) * schlick_share(cosine); }
/// The same for a boundary of transparent matter. From the dense side the cosine is that of the refracted direction, and beyond the
/// critical angle all is reflected.
inline float fresnel_schlick(float cosine, float eta) {
  const float r = (eta - 1) / (eta + 1);
  if (eta < 1) {
    const float sine2 = std::max(0.f, 1 - cosine * cosine) / (eta * eta);
    if (sine2 >= 1) return 1;
    cosine = std::sqrt(1 - sine2);
  }
  return r * r + (1 - r * r) * schlick_share(cosine);
}

/// Of a sheet whose sides reflect r each, with all the light that goes to and fro between them: r + (1 - r)^2 r / (1 - r^2).
inline float sheet_reflectance(float r) { return 2 * r / (1 + r); }

}  // namespace sg::trace
