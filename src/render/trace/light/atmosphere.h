// SPDX-License-Identifier: Apache-2.0
// The air about the Earth, by what it takes from light and where it sends that. RGB at the dominant wavelengths of the primaries, about
// 680, 550 and 440 nm. Source of the coefficients: Bruneton, "A qualitative and quantitative evaluation of 8 clear sky models" (2017), as
// Hillaire, "A scalable and production ready sky and atmosphere rendering technique" (2020), gives them.
#pragma once
#include <cmath>

#include "base/vec.h"

namespace sg::trace {

/// Lengths in metres, coefficients per metre.
struct Atmosphere {
  double ground = 6360e3, top = 6420e3;  ///< radii
  Vec3 rayleigh{5.802e-6, 13.558e-6, 33.1e-6};
  double rayleigh_height = 8e3;  ///< over which there is e times less of it
  double mie_scattering = 3.996e-6, mie_extinction = 4.40e-6;
  double mie_height = 1.2e3, mie_g = 0.8;
  Vec3 ozone{0.650e-6, 1.881e-6, 0.085e-6};        ///< absorbs
  double ozone_middle = 25e3, ozone_width = 30e3;  ///< of a tent
  double albedo = 0.3;                             ///< of the ground

  /// With more or less dust than on a clear day.
  static Atmosphere with_haze(double factor) {
    Atmosphere a;
    a.mie_scattering *= factor, a.mie_extinction *= factor;
    return a;
  }
};

/// Of the air at a height above the ground.
struct AirAt {
  Vec3 rayleigh, mie, extinction;  ///< the first two scatter
};
AirAt air_at(const Atmosphere& a, double height);

/// Along the ray from radius r, mu the cosine of its angle from the vertical: distance to the ground, or, where it passes that, to the top.
/// Negative: it meets neither. r is at most the top's.
struct AirPath {
  double length;
  bool meets_ground;
};
AirPath air_path(const Atmosphere& a, double r, double mu);

/// Optical depth over a length of such a ray, by the midpoint rule with that many steps, which grow with the square of their number: the
/// error falls with the square of it, once the kinks of the ozone are resolved.
Vec3 optical_depth(const Atmosphere& a, double r, double mu, double length, int steps);
/// exp(-optical depth) to the top; 0 where the ground is in the way.
Vec3 transmittance(const Atmosphere& a, double r, double mu, int steps);

}  // namespace sg::trace
