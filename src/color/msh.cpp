// SPDX-License-Identifier: Apache-2.0
#include "color/msh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sg {

Msh lab_to_msh(Vec3 lab) {
  const double m = length(lab);
  const double s = m > 1e-3 ? std::acos(std::clamp(lab.x / m, -1.0, 1.0)) : 0;
  return {m, s, s > 1e-3 ? std::atan2(lab.z, lab.y) : 0};
}

Vec3 msh_to_lab(Msh c) { return {c.m * std::cos(c.s), c.m * std::sin(c.s) * std::cos(c.h), c.m * std::sin(c.s) * std::sin(c.h)}; }

double adjusted_hue(Msh saturated, double m) {
  if (saturated.m >= m - 0.1) return saturated.h;
  const double spin = saturated.s * std::sqrt(m * m - saturated.m * saturated.m) / (saturated.m * std::sin(saturated.s));
  return saturated.h > -std::numbers::pi / 3 ? saturated.h + spin : saturated.h - spin;
}

}  // namespace sg
