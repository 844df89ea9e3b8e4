// SPDX-License-Identifier: Apache-2.0
// Light that comes from all around: even, with soft bright sides, or by a picture of all directions.
#pragma once
#include <array>
#include <memory>
#include <span>

#include "base/vec.h"
#include "render/trace/sampling/distribution.h"

namespace sg::trace {

/// Radiance by direction. A picture is in equirectangular form: rows from `up` down, columns once around from -`front` by the left, so that
/// its middle is what lies in front; between the middles of pixels it is interpolated. Directions are drawn by how bright pixels are on
/// average and how much of the sphere they cover.
class Environment {
 public:
  Environment() = default;  ///< dark
  explicit Environment(Vec3f radiance) : even_(radiance) {}
  /// `pixels`: width * height linear RGB. Throws Error(usage) for numbers that are negative or not finite, and for no pixels.
  Environment(std::span<const Vec3f> pixels, size_t width, Vec3 up, Vec3 front, float factor);

  /// Light from around the direction `towards` (unit): `radiance` there, less beside it, nothing where the cosine is below `least`.
  struct Side {
    Vec3f radiance, towards{0, 0, 1};
    float least = 0;
  };
  /// Even light, and light from two sides more.
  Environment(Vec3f even, const Side& first, const Side& second) : even_(even), sides_{first, second} {}

  /// So much alike everywhere that nothing is gained by asking for it where it is bright: it is drawn evenly.
  bool soft() const { return !picture_; }
  bool dark() const { return mean() == Vec3f(); }
  Vec3f radiance(Vec3f direction) const;
  /// Its mean over all directions.
  Vec3f mean() const;

  struct Sample {
    Vec3f direction, radiance;
    float pdf;  ///< per solid angle
  };
  Sample sample(Vec2f u) const;
  float pdf(Vec3f direction) const;

 private:
  struct Picture;
  Vec2f place(Vec3f direction) const;
  Vec3f even_;
  std::array<Side, 2> sides_;
  std::shared_ptr<const Picture> picture_;
};

}  // namespace sg::trace
