// SPDX-License-Identifier: Apache-2.0
// The light that a scene is in when nothing is said of it: that of the rasterizer, with soft shadows and a sky.
#pragma once
#include <vector>

#include "render/trace/light/lights.h"
#include "scene/scene.h"

namespace sg::trace {

struct Studio {
  std::vector<AnyLight> lights;
  Environment environment;
};
/// The scene's lights as discs in the sky, twelve degrees across, and an even sky: a white surface that faces the first of the default ones
/// is white.
Studio studio_of(const Scene& scene, const Projection& projection);

}  // namespace sg::trace
