// SPDX-License-Identifier: Apache-2.0
// Directions relative to a surface: z along its normal.
#pragma once
#include <cmath>

#include "base/vec.h"

namespace sg::trace {

/// Three unit vectors, right-handed, each square to the others.
struct LocalFrame {
  Vec3f x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  /// z along the unit vector n, x and y anyhow (Duff et al. 2017, "Building an orthonormal basis, revisited"): continuous but where n.z
  /// changes its sign.
  static LocalFrame about(Vec3f n) {
    const float sign = std::copysign(1.f, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
    return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
  }
  /// x as near to the tangent as n allows; one along n counts as none.
  static LocalFrame about(Vec3f n, Vec3f tangent) {
    Vec3f x = tangent - n * dot(n, tangent);
    if (!(length(x) > 1e-5f * length(tangent))) return about(n);
    x = normalize(x);
    x = normalize(x - n * dot(n, x));  // what the first difference lost
    return {x, cross(n, x), n};
  }
  Vec3f to_local(Vec3f world) const { return {dot(world, x), dot(world, y), dot(world, z)}; }
  Vec3f to_world(Vec3f local) const { return x * local.x + y * local.y + z * local.z; }
};

}  // namespace sg::trace
