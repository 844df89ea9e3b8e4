// SPDX-License-Identifier: Apache-2.0
// The light of a scene as it is traced: what is stated, or else that of the rasterizer, with soft shadows and a sky.
#pragma once
#include <optional>
#include <vector>

#include "render/trace/light/lights.h"
#include "render/trace/tree/ray.h"
#include "scene/scene.h"

namespace sg::trace {

/// What is seen where nothing is met, in the place of the picture's background.
struct Backdrop {
  bool seen = false;
  Environment environment;
  std::optional<DistantLight> sun;
  /// As it is displayed: at most 1, so that a pixel half on the sun is half white.
  Vec3f radiance(Vec3f direction) const;
};

struct Studio {
  std::vector<AnyLight> lights;  ///< in traced coordinates
  Environment environment;
  Backdrop backdrop;
};
/// Where nothing is stated: the scene's lights as discs in the sky, twelve degrees across, and a soft sky that is bright above the viewer;
/// a white surface that faces the first of the default ones is white. Stated lights have a dim even sky, a stated environment no lights but
/// stated ones. Throws Error(usage) for a sun that is stated as a light below the horizon.
Studio studio_of(const Scene& scene, const Projection& projection, const Placement& placement);

}  // namespace sg::trace
