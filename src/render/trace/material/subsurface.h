// SPDX-License-Identifier: Apache-2.0
// Light that wanders below a surface: what a random walk needs, and the profile that it is compared with.
#pragma once
#include "render/shade/scatter_albedo.h"

namespace sg::trace {

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
