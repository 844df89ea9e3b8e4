// SPDX-License-Identifier: Apache-2.0
// The sky of a sun at some height: what the air scatters of its light once, by integrals along each line of sight, and more than once, as
// light that goes everywhere alike (Hillaire 2020, section 5.5).
#pragma once
#include <vector>

#include "base/vec.h"
#include "render/trace/light/atmosphere.h"

namespace sg::trace {

constexpr double sun_width = 0.53;  ///< degrees

/// Light of the sun at the top of the air is 1, at right angles.
struct Sky {
  int width = 0, height = 0;
  std::vector<Vec3f> pixels;  ///< radiance, as an Environment takes it, with the sun in front: the middle column
  Vec3 sun;                   ///< irradiance of what faces the sun; 0 when it has set
  Vec3 level;                 ///< irradiance of what lies level, by the sky alone
  Vec3 facing;                ///< of what faces the sun, by the sky and the ground alone
};

class SkyModel {
 public:
  /// `steps`: of the integrals along lines of sight.
  explicit SkyModel(const Atmosphere& air, int steps = 48);

  const Atmosphere& air() const { return air_; }
  /// Share of the sun's light that is left at a radius, mu the cosine of its angle from the vertical: from a table of
  /// transmittance(); 0 where the ground is in the way.
  Vec3 sunlight(double r, double mu) const;
  /// Radiance of light scattered more than once, for a scattering coefficient of 1 and the sun at mu.
  Vec3 scattered_often(double r, double mu) const;
  /// What is seen from `r` above the middle along `direction`, z up; `sun` is where it stands. `sky`: irradiance of the ground by it,
  /// beside the sun. `often`: with light that is scattered more than once.
  Vec3 radiance(double r, Vec3 direction, Vec3 sun, Vec3 sky, bool often = true) const;

 private:
  Vec3 along(double r, Vec3 direction, Vec3 sun, double length, bool often, Vec3& passed) const;
  void fill_sunlight();
  void fill_scattered();

  Atmosphere air_;
  int steps_;
  std::vector<Vec3> sunlight_, often_;
};

/// `elevation` of the sun in degrees. The picture is `height` x 2 `height`, symmetric about its middle. The same for any number of threads.
Sky make_sky(const SkyModel& model, double elevation, int height);

}  // namespace sg::trace
