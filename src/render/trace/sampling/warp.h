// SPDX-License-Identifier: Apache-2.0
// From the unit square to discs, directions and triangles, each with its density. Directions are unit vectors about the z axis; densities
// are per solid angle. The maps keep strata together: neighbours in the square are neighbours on the other side.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/vec.h"

namespace sg::trace {

constexpr float pi = std::numbers::pi_v<float>;

/// Uniform on the unit disc, by rings (Shirley, Chiu 1997). The angle is within pi / 4 of an axis, where the first terms of the series of
/// sine and cosine are exact to a rounding.
inline Vec2f concentric_disc(Vec2f u) {
  const float x = 2 * u.x - 1, y = 2 * u.y - 1;
  if (x == 0 && y == 0) return {};
  const bool wide = std::abs(x) > std::abs(y);
  const float r = wide ? x : y, angle = (pi / 4) * ((wide ? y : x) / r), a = angle * angle;
  const float cosine = 1 - a * (1 / 2.f - a * (1 / 24.f - a * (1 / 720.f - a * (1 / 40320.f))));
  const float sine = angle - angle * (a * (1 / 6.f - a * (1 / 120.f - a * (1 / 5040.f - a * (1 / 362880.f)))));
  return wide ? Vec2f{r * cosine, r * sine} : Vec2f{r * sine, r * cosine};
}
inline float concentric_disc_pdf() { return 1 / pi; }

/// A density of cos / pi on the half z > 0 (Malley: the disc raised to the sphere).
inline Vec3f cosine_hemisphere(Vec2f u) {
  const Vec2f d = concentric_disc(u);
  return {d.x, d.y, std::sqrt(std::max(0.f, 1 - d.x * d.x - d.y * d.y))};
}
inline float cosine_hemisphere_pdf(float cosine) { return std::max(0.f, cosine) / pi; }

/// Uniform over the cap 1 - z < `rise`, 0 < rise <= 2; the rise instead of the cosine, so that narrow cones stay exact.
inline Vec3f uniform_cone(Vec2f u, float rise) {
  const Vec2f d = concentric_disc(u);
  const float below_top = rise * (d.x * d.x + d.y * d.y);  // 1 - z, uniform in [0, rise]
  const float stretch = std::sqrt(std::max(0.f, rise * (2 - below_top)));
  return {d.x * stretch, d.y * stretch, 1 - below_top};
}
inline float uniform_cone_pdf(float rise) { return 1 / (2 * pi * rise); }

inline Vec3f uniform_hemisphere(Vec2f u) { return uniform_cone(u, 1); }
inline float uniform_hemisphere_pdf() { return uniform_cone_pdf(1); }

inline Vec3f uniform_sphere(Vec2f u) { return uniform_cone(u, 2); }
inline float uniform_sphere_pdf() { return uniform_cone_pdf(2); }

/// Barycentric coordinates (of the three corners) of a point that is uniform in a triangle; its density is 1 / area. The square is folded
/// along its diagonal without a square root (Heitz 2019, "A low-distortion map between triangle and square").
inline Vec3f uniform_triangle(Vec2f u) {
  float b0 = u.x, b1 = u.y;
  if (b1 > b0) b0 *= 0.5f, b1 -= b0;
  else b1 *= 0.5f, b0 -= b1;
  return {b0, b1, std::max(0.f, 1 - b0 - b1)};
}

}  // namespace sg::trace
