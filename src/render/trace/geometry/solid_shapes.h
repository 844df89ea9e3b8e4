// SPDX-License-Identifier: Apache-2.0
// Balls, discs and capsules: what points and lines become. A ray is taken against them in double, from f32 numbers: what is left of
// rounding is far below a step off the surface (surface_point.h).
#pragma once
#include <cstdint>

#include "render/trace/tree/ray.h"

namespace sg::trace {

/// Where a ray meets a shape: the place on the very shape, in double.
struct ShapePoint {
  Vec3 place, normal, along;  ///< unit outer normal; along: a direction for the tangent, or zero
};

struct Ball {
  Vec3f center;
  float radius;
  uint32_t number;  ///< the primitive's

  Box3f bounds() const;
  /// The least t with 0 < t <= t_max at which the ray passes the surface, from either side; sets u where the shape has one.
  bool meet(const Ray& ray, float t_max, float& t, float& u) const;
  ShapePoint point(const Ray& ray, const Hit& hit) const;
};

struct Disc {
  Vec3f center, normal;  ///< unit
  float radius;
  uint32_t number;

  Box3f bounds() const;
  bool meet(const Ray& ray, float t_max, float& t, float& u) const;
  ShapePoint point(const Ray& ray, const Hit& hit) const;
};

/// All that is nearer to the segment than the radius: neighbours in a line share a round joint.
struct Capsule {
  Vec3f a, b;
  float radius;
  uint32_t number;

  Box3f bounds() const;
  bool meet(const Ray& ray, float t_max, float& t, float& u) const;
  ShapePoint point(const Ray& ray, const Hit& hit) const;
};

}  // namespace sg::trace
