// SPDX-License-Identifier: Apache-2.0
// Axis directions of medical volumes.
#pragma once
#include <fmt/core.h>

#include "base/error.h"
#include "base/vec.h"

namespace sg {

/// The matrix whose columns are the `n` given axes made unit, completed to three by perpendicular ones (right-handed).
/// Throws Error(data) naming `where` for axes without length or all in one plane.
inline Mat3 direction_of(const Vec3* axes, int n, const std::string& where) {
  Vec3 c[3];
  for (int a = 0; a < n; ++a) {
    const double l = length(axes[a]);
    if (!(l > 0) || !std::isfinite(l)) fail_data(fmt::format("the direction of axis {} has no length", a), where);
    c[a] = axes[a] / l;
  }
  if (n < 2) {
    if (n < 1) c[0] = {1, 0, 0};
    // Any vector that is perpendicular; the unit vector along the smallest coordinate is farthest from c[0].
    const Vec3 s(std::abs(c[0].x), std::abs(c[0].y), std::abs(c[0].z));
    const Vec3 far = s.y <= s.x && s.y <= s.z ? Vec3(0, 1, 0) : s.z <= s.x ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
    c[1] = normalize(far - c[0] * dot(far, c[0]));
  }
  if (n < 3) c[2] = normalize(cross(c[0], c[1]));
  Mat3 m;
  for (int i = 0; i < 3; ++i)
    for (int a = 0; a < 3; ++a) m.m[i][a] = c[a][i];
  if (!(std::abs(determinant(m)) > 1e-9)) fail_data("the directions of the axes are coplanar", where);
  return m;
}

}  // namespace sg
