// SPDX-License-Identifier: Apache-2.0
#include "render/trace/geometry/surface_point.h"

#include <bit>
#include <cmath>
#include <limits>

namespace sg::trace {

namespace {

/// Arithmetic in double is off by 2^-53 of coordinates up to 1 a few dozen times at most; near zero f32 numbers tell less than that apart.
constexpr double in_double = 0x1p-42;

/// The next number further from zero, or nearer to it: finite ones that are not zero.
float by_one(float f, bool further) { return std::bit_cast<float>(std::bit_cast<uint32_t>(f) + (further ? 1u : ~0u)); }

float away(double x, double step) {
  const auto f = float(x);
  const bool up = step > 0 && double(f) < x, down = step < 0 && double(f) > x;
  if (!up && !down) return f;
  if (f == 0) return std::copysign(std::numeric_limits<float>::denorm_min(), float(step));
  return by_one(f, up == (f > 0));
}

}  // namespace

Rounded rounded(Vec3 place, Vec3 more) {
  Rounded r{Vec3f(place), {}};
  for (int a = 0; a < 3; ++a) r.error[a] = float((std::abs(place[a]) * half_unit + more[a]) * 1.0001 + in_double);
  return r;
}

Vec3f leave(const SurfacePoint& p, Vec3f direction) {
  const Vec3 n(p.face_normal);
  const double out = dot(n, Vec3(direction)) < 0 ? -1 : 1;
  const double reach = std::abs(n.x) * p.error.x + std::abs(n.y) * p.error.y + std::abs(n.z) * p.error.z;
  const Vec3 step = n * (out * 2 * reach);
  return {away(double(p.position.x) + step.x, step.x), away(double(p.position.y) + step.y, step.y),
          away(double(p.position.z) + step.z, step.z)};
}

Vec3f tangent_of(Vec3f normal, Vec3f along) {
  const Vec3 n(normal), v(along);
  Vec3 t = v - n * dot(n, v);
  if (!(dot(t, t) > 1e-12 * dot(v, v))) {
    const Vec3 axis = std::abs(n.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    t = axis - n * dot(n, axis);
  }
  return Vec3f(normalize(t));
}

}  // namespace sg::trace
