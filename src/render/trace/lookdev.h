// SPDX-License-Identifier: Apache-2.0
// Materials as they look: a ball of each on a chequered floor.
#pragma once
#include "base/context.h"
#include "image/image.h"
#include "scene/items/surface_material.h"

namespace sg {

/// A square picture. `noise` as in LightOptions.
Image lookdev_ball(const SurfaceMaterial& material, int width, double noise, Context& context);

}  // namespace sg
