// SPDX-License-Identifier: Apache-2.0
// RayFootprint: how large a ray is, so that pictures on surfaces are filtered over what it stands for.
#pragma once
#include <algorithm>
#include <cmath>

#include "base/vec.h"
#include "render/trace/sampling/local_frame.h"

namespace sg::trace {

/// From a ray to those beside it, to the right and down: at its start, and what is added with each unit of its length (ray differentials,
/// Igehy 1999). Traced coordinates. All zero: of no size, which shows pictures as fine as they are.
struct RayFootprint {
  Vec3f right, down, right_along, down_along;

  /// Each path stands for a part of its pixel, as the rasterizer's two samples across do: all of them together see the pixel.
  static constexpr float paths_across = 2;

  Vec3f right_at(float t) const { return right + right_along * t; }
  Vec3f down_at(float t) const { return down + down_along * t; }
  bool none() const { return *this == RayFootprint(); }
  friend bool operator==(const RayFootprint&, const RayFootprint&) = default;

  RayFootprint after(float t) const { return {right_at(t), down_at(t), right_along, down_along}; }
  /// As a plane mirror throws it back; exact there, and of curved ones without what their bend adds.
  RayFootprint mirrored(Vec3f normal) const {
    const auto back = [&](Vec3f v) { return v - normal * (2 * dot(v, normal)); };
    return {back(right), back(down), back(right_along), back(down_along)};
  }
  /// About another direction: as wide as it is, and opening at least by `opening`, per length.
  RayFootprint turned(Vec3f direction, float opening) const {
    const LocalFrame frame = LocalFrame::about(direction);
    const float width = std::sqrt(length(right) * length(down)),
                opens = std::max(opening, std::sqrt(length(right_along) * length(down_along)));
    const Vec3f x = frame.to_world({1, 0, 0}), y = frame.to_world({0, 1, 0});
    return {x * width, y * width, x * opens, y * opens};
  }
};

}  // namespace sg::trace
