// SPDX-License-Identifier: Apache-2.0
// Functions whose zero surfaces have known areas, volumes and genus.
#pragma once
#include <cmath>

#include "base/vec.h"

namespace sg::test {

/// Radius 1.
inline double sphere(Vec3 p) { return length(p) - 1; }
/// Radii 1 and 0.4, around z.
inline double torus(Vec3 p) { return std::hypot(std::hypot(p.x, p.y) - 1, p.z) - 0.4; }
/// One piece of genus 5 within [-3,3]^3.
inline double tangle(Vec3 p) {
  auto q = [](double x) { return x * x * x * x - 5 * x * x; };
  return q(p.x) + q(p.y) + q(p.z) + 11.8;
}

/// A plane that lies along no axis.
inline const Vec3 plane_normal = normalize(Vec3(1, 2, 0.7));
inline double oblique_plane(Vec3 p) { return dot(plane_normal, p) - 0.1234; }

}  // namespace sg::test
