// SPDX-License-Identifier: Apache-2.0
// A ray, where it meets something, and the coordinates that it is traced in.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

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

/// The points origin + t direction, 0 < t <= t_max, in traced coordinates (Placement). The direction is of unit length.
struct Ray {
  Vec3f origin, direction;
  float t_max = std::numeric_limits<float>::infinity();
};

/// Whether the ray leads anywhere: its numbers are finite, and the direction is not zero.
inline bool can_trace(const Ray& r) {
  const float sum = (r.origin.x + r.origin.y + r.origin.z) * 0 + (r.direction.x + r.direction.y + r.direction.z) * 0;
  return sum == 0 && !(r.direction == Vec3f());
}

/// The nearest of several at the same t is that of the lowest object, then of the lowest primitive.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  uint32_t object = 0;     ///< number in PreparedScene::items, or of what comes after them
  uint32_t primitive = 0;  ///< number in the object
  float u = 0, v = 0;      ///< triangles: the weights of the second and third corner; tubes: u = place along the segment, 0 to 1
};

struct Box3f {
  Vec3f lo{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity()};
  Vec3f hi{-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};

  bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
  friend bool operator==(const Box3f&, const Box3f&) = default;
};

}  // namespace sg::trace
