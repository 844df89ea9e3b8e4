// SPDX-License-Identifier: Apache-2.0
// ShadowRays: light that arrives unless something opaque is in its way. Rays wait until there are enough to be followed together.
#pragma once
#include <bit>

#include "render/trace/geometry/geometry.h"

namespace sg::trace {

class ShadowRays {
 public:
  explicit ShadowRays(const Geometry& geometry) : geometry_(geometry) {}

  /// Adds `light` to `sum`, by settle() at the latest, if nothing is met along the ray. In the order in which they were asked for.
  void add(const Ray& ray, Vec3f light, Vec3f& sum) {
    if (count_ == Geometry::most_together) settle();
    rays_[count_] = ray, light_[count_] = light, sum_[count_++] = &sum;
  }
  void settle() {
    const uint64_t stopped = geometry_.blocked(rays_, count_);
    for (int i = 0; i < count_; ++i)
      if (!(stopped >> i & 1)) *sum_[i] += light_[i];
    count_ = 0;
  }

 private:
  const Geometry& geometry_;
  int count_ = 0;
  Ray rays_[Geometry::most_together];
  Vec3f light_[Geometry::most_together];
  Vec3f* sum_[Geometry::most_together];
};

}  // namespace sg::trace
