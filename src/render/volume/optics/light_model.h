// SPDX-License-Identifier: Apache-2.0
// Light on one place of a volume: a factor of the colour, and white on top of it.
#pragma once
#include "render/volume/lattice/kernels.h"

namespace sg::volume {

struct Lit {
  float diffuse = 1, specular = 0;
};

/// Blinn-Phong on both sides of the gradient (world, value per length); where the field changes by less than a surface does over the
/// length `edge`, the colour stays as it is.
Lit light_at(const LitRay& lit, Vec3f gradient, float edge, float per_scale);

}  // namespace sg::volume
