// SPDX-License-Identifier: Apache-2.0
// Light that wanders below a surface: what a random walk needs, and the profile that it is compared with.
#pragma once
#include "base/vec.h"

namespace sg::trace {

/// The share that each collision scatters, for which a half-space without a reflecting boundary returns `surface` of diffuse light, per
/// channel. Van de Hulst's fit (1980) of the reflectance, (1 - s)(1 - 0.139 s) / (1 + 1.17 s) with s^2 = (1 - a) / (1 - g a), solved for a;
/// g: mean cosine of scattering, -1 < g < 1.
Vec3f single_scatter_albedo(Vec3f surface, float g);

/// How far from where it enters light comes out again, of one channel: the normalised diffusion of Christensen and Burley (2015), for
/// diffuse light that enters.
class DiffusionProfile {
 public:
  /// mean_free_path > 0 between collisions; surface: what comes out, 0 to 1.
  DiffusionProfile(float mean_free_path, float surface);
  /// Per area at distance r > 0; integrates to `surface` over the plane.
  float operator()(float r) const;
  /// A distance with the density 2 pi r R(r) / surface; u in [0, 1).
  float sample(float u) const;
  /// Per area, of points at distance r in a random direction.
  float pdf(float r) const;

 private:
  float length_, surface_;
};

}  // namespace sg::trace
