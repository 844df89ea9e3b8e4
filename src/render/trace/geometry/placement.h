// SPDX-License-Identifier: Apache-2.0
// Placement: where something lies in the world, and the coordinates in which it is traced.
#pragma once
#include <algorithm>
#include <cmath>

#include "base/vec.h"

namespace sg::trace {

/// Traced coordinates are f32 numbers of about [-1, 1] for whatever size and place in the world: moved to the middle of the scene and
/// scaled by a power of two, which rounds nothing.
struct Placement {
  Vec3 middle;
  double scale = 1;  ///< traced length of a world length of 1

  /// Half of the longest side becomes 0.5 to 1. A box that is empty or a point is not scaled.
  static Placement of(const Box3& world) {
    Placement p;
    p.middle = world.center();
    if (world.empty()) return p;
    const Vec3 half = world.size() * 0.5;
    const double largest = std::max({half.x, half.y, half.z});
    if (largest > 0 && std::isfinite(largest)) p.scale = std::ldexp(1.0, std::clamp(-std::ilogb(largest) - 1, -1000, 1000));
    return p;
  }
  Vec3f traced(Vec3 world) const { return Vec3f((world - middle) * scale); }
  Vec3 world(Vec3f traced) const { return Vec3(traced) / scale + middle; }
  friend bool operator==(const Placement&, const Placement&) = default;
};

}  // namespace sg::trace
