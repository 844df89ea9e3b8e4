// SPDX-License-Identifier: Apache-2.0
// One ray against one triangle: the reference of triangles_simd.cpp, operation by operation.
//
// The corners are moved to where the ray starts and sheared so that it runs along an axis (Woop, Benthin, Wald 2013); the triangle is met
// when the origin lies inside its shadow. Of a sheared edge the test takes the sign of x1 y2 - y1 x2, two products that are each rounded
// once: rounding keeps the order of the products, so the sign is right or the difference is zero, and it is the same from both sides of a
// shared edge. With zero as inside no ray slips between neighbours, nor through a corner; what double precision was taken for in the paper
// is not needed, as long as nothing fuses a product with the difference.
#pragma once
#include <algorithm>
#include <cmath>

#include "render/trace/tree/ray.h"

namespace sg::trace {

/// What the test wants of a ray.
struct ShearedRay {
  Vec3f origin, direction;
  int kx, ky, kz;    ///< kz: the axis along which the direction is longest
  float sx, sy, sz;  ///< shear, and 1 / direction along kz

  /// Axes are looked up, not decided on: of rays that go anywhere such branches would be foretold wrong.
  explicit ShearedRay(const Ray& r) : origin(r.origin), direction(r.direction) {
    const float d[3] = {direction.x, direction.y, direction.z}, size[3] = {std::abs(d[0]), std::abs(d[1]), std::abs(d[2])};
    const int longer = !(size[0] > size[1]);
    constexpr int after[3] = {1, 2, 0};
    kz = size[longer] > size[2] ? longer : 2, kx = after[kz], ky = after[kx];
    sx = d[kx] / d[kz], sy = d[ky] / d[kz], sz = 1 / d[kz];
  }
};

/// Where the ray meets the triangle's plane, from f32 corners in double: for triangles that reach behind the ray's start, where rounding in
/// f32 could tell a start on the triangle from one behind it no more. `farthest`: of the corners, in units of the direction.
/// NaN when that is not in front of the start, or further than the farthest corner, as a plane seen edge-on may be.
inline float exact_distance(const ShearedRay& r, Vec3f a, Vec3f b, Vec3f c, float farthest) {
  const Vec3 p(a), n = cross(Vec3(b) - p, Vec3(c) - p);
  const double t = dot(n, p - Vec3(r.origin)) / dot(n, Vec3(r.direction));
  const double limit = double(farthest) * (1 + 0x1p-20);
  return t > 0 && t <= limit ? float(t) : NAN;
}

/// Whether the ray meets the triangle at some 0 < t <= t_max; sets t and the weights u of b and v of c.
inline bool meet_triangle(const ShearedRay& r, Vec3f a, Vec3f b, Vec3f c, float t_max, float& t, float& u, float& v) {
  const float az = a[r.kz] - r.origin[r.kz], bz = b[r.kz] - r.origin[r.kz], cz = c[r.kz] - r.origin[r.kz];
  const float ax = (a[r.kx] - r.origin[r.kx]) - r.sx * az, ay = (a[r.ky] - r.origin[r.ky]) - r.sy * az;
  const float bx = (b[r.kx] - r.origin[r.kx]) - r.sx * bz, by = (b[r.ky] - r.origin[r.ky]) - r.sy * bz;
  const float cx = (c[r.kx] - r.origin[r.kx]) - r.sx * cz, cy = (c[r.ky] - r.origin[r.ky]) - r.sy * cz;
  const float wa = cx * by - cy * bx, wb = ax * cy - ay * cx, wc = bx * ay - by * ax;
  if (!((wa >= 0 && wb >= 0 && wc >= 0) || (wa <= 0 && wb <= 0 && wc <= 0))) return false;
  const float det = (wa + wb) + wc;
  if (det == 0) return false;
  const float za = az * r.sz, zb = bz * r.sz, zc = cz * r.sz;
  if (za <= 0 && zb <= 0 && zc <= 0) return false;
  const bool in_front = za > 0 && zb > 0 && zc > 0;
  t = in_front ? ((wa * za + wb * zb) + wc * zc) / det : exact_distance(r, a, b, c, std::max({za, zb, zc}));
  if (!(t <= t_max)) return false;
  u = wb / det, v = wc / det;
  return true;
}

}  // namespace sg::trace
