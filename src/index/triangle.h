// SPDX-License-Identifier: Apache-2.0
// One triangle: the nearest point of it, and where a ray meets it.
#pragma once
#include <utility>

#include "base/vec.h"

namespace sg {

/// Barycentric coordinates of b and c of the point of triangle a b c nearest to x (by Voronoi regions; Ericson 2005, 5.1.5).
inline Vec2 nearest_in_triangle(Vec3 x, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a, ac = c - a, ax = x - a;
  const double d1 = dot(ab, ax), d2 = dot(ac, ax);
  if (d1 <= 0 && d2 <= 0) return {0, 0};
  const Vec3 bx = x - b;
  const double d3 = dot(ab, bx), d4 = dot(ac, bx);
  if (d3 >= 0 && d4 <= d3) return {1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {d1 / (d1 - d3), 0};
  const Vec3 cx = x - c;
  const double d5 = dot(ab, cx), d6 = dot(ac, cx);
  if (d6 >= 0 && d5 <= d6) return {0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {1 - w, w};
  }
  const double sum = va + vb + vc;
  return sum > 0 ? Vec2{vb / sum, vc / sum} : Vec2{0, 0};
}

/// A ray against triangles that never slips between two that share an edge: the sides of a shared edge are computed from the same two
/// projected points and differ only in sign (Woop, Benthin, Wald 2013).
class TriangleRay {
 public:
  TriangleRay(Vec3 x, Vec3 d) : x_(x) {
    const Vec3 m(std::abs(d.x), std::abs(d.y), std::abs(d.z));
    kz_ = m.x > m.y ? (m.x > m.z ? 0 : 2) : m.y > m.z ? 1 : 2;
    kx_ = (kz_ + 1) % 3, ky_ = (kz_ + 2) % 3;
    sx_ = d[kx_] / d[kz_], sy_ = d[ky_] / d[kz_], sz_ = 1 / d[kz_];
  }
  /// Where it meets the triangle (edges belong to it); NaN when it does not or runs in its plane. The same for any order of the corners
  /// up to rounding: sort them for the very same number.
  double hit(Vec3 a, Vec3 b, Vec3 c) const {
    const Projected p = project(a), q = project(b), r = project(c);
    const double u = r.x * q.y - r.y * q.x, v = p.x * r.y - p.y * r.x, w = q.x * p.y - q.y * p.x;
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return NAN;
    const double det = u + v + w;
    return det == 0 ? NAN : (u * p.z + v * q.z + w * r.z) / det;
  }

 private:
  struct Projected {
    double x, y, z;  // across the ray, across the ray, along it in units of d
  };
  Projected project(Vec3 a) const {
    const Vec3 v = a - x_;
    return {v[kx_] - sx_ * v[kz_], v[ky_] - sy_ * v[kz_], sz_ * v[kz_]};
  }
  Vec3 x_;
  int kx_, ky_, kz_;
  double sx_, sy_, sz_;
};

}  // namespace sg
