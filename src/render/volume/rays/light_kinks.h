// SPDX-License-Identifier: Apache-2.0
// Where light jumps along a ray: where the surface that it falls on turns over, and where lamps begin to reach that.
#pragma once
#include "render/volume/medium/stretch.h"
#include "render/volume/rays/light_model.h"

namespace sg::volume {

/// Places of a stretch, ascending.
struct LightKinks {
  static constexpr int most = 20;
  int count = 0;
  double at[most];
};

/// Whether the light depends on the gradient.
bool has_kinks(const LitRay& lit);

/// From the gradient at the ends of a stretch and at its thirds, queried from the walker and taken as a cubic, which is exact in lattices
/// and on straight cells.
LightKinks light_kinks(const LitRay& lit, RayField& walker, const Stretch& stretch, Vec3f first, Vec3f last);
/// The same, with the gradients at the ends queried just inside them.
LightKinks light_kinks(const LitRay& lit, RayField& walker, const Stretch& stretch);

/// Of a stretch: at this distance from a kink or a cell face, light is that of one side.
constexpr double hair = 1e-6;

}  // namespace sg::volume
