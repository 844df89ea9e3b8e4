// SPDX-License-Identifier: Apache-2.0
#include "render/trace/light/atmosphere.h"

#include <algorithm>

namespace sg::trace {

AirAt air_at(const Atmosphere& a, double height) {
  const double h = std::max(height, 0.0), r = std::exp(-h / a.rayleigh_height), m = std::exp(-h / a.mie_height);
  const double o = std::max(0.0, 1 - std::abs(h - a.ozone_middle) / (a.ozone_width / 2));
  const Vec3 one{1, 1, 1}, rayleigh = a.rayleigh * r;
  return {rayleigh, one * (a.mie_scattering * m), rayleigh + one * (a.mie_extinction * m) + a.ozone * o};
}

AirPath air_path(const Atmosphere& a, double r, double mu) {
  // Products of sums keep the digits that differences of squares would lose.
  const double across2 = r * r * (1 - mu * mu), ground2 = a.ground * a.ground - across2;
  if (mu < 0 && ground2 >= 0) {
    const double b = -r * mu, c = (r - a.ground) * (r + a.ground);  // t^2 - 2 b t + c = 0, the smaller root
    return {c / (b + std::sqrt(ground2)), true};
  }
  const double top2 = a.top * a.top - across2;
  if (!(top2 >= 0)) return {-1, false};
  const double root = std::sqrt(top2), c = (a.top - r) * (a.top + r);
  return {mu > 0 ? c / (r * mu + root) : root - r * mu, false};
}

Vec3 optical_depth(const Atmosphere& a, double r, double mu, double length, int steps) {
  Vec3 sum;
  for (int i = 0; i < steps; ++i) {
    // Short steps where the ray begins, which is where the air is dense.
    const double from = double(i) / steps, to = double(i + 1) / steps, t = length * (from * from + to * to) / 2;
    const double radius = std::sqrt(r * r + t * t + 2 * r * mu * t);
    sum += air_at(a, radius - a.ground).extinction * (length * (to * to - from * from));
  }
  return sum;
}

Vec3 transmittance(const Atmosphere& a, double r, double mu, int steps) {
  const AirPath path = air_path(a, r, mu);
  if (path.meets_ground) return {};
  const Vec3 depth = path.length > 0 ? optical_depth(a, r, mu, path.length, steps) : Vec3();
  return {std::exp(-depth.x), std::exp(-depth.y), std::exp(-depth.z)};
}

}  // namespace sg::trace
