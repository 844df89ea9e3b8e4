// SPDX-License-Identifier: Apache-2.0
// Features: what is seen first in each pixel, with next to no noise: colours, directions of surfaces, distances.
#pragma once
#include <array>

#include "base/context.h"
#include "image/image.h"
#include "render/trace/integrators/picture_camera.h"
#include "render/trace/integrators/world.h"
#include "render/trace/light_options.h"
#include "render/trace/progress/light_watch.h"
#include "scene/camera.h"

namespace sg::trace {

/// Means over the first rays of each pixel, those that its paths begin with (at most 8; 4 where there is matter), each by the share of the
/// ray that is stopped, and the variances of these means.
struct Features {
  enum Channel { albedo, normal = 3, depth = 6, cover = 7, channels = 8 };  ///< RGB; in the world, towards the viewer; traced; 0 to 1
  int width = 0, height = 0;
  std::array<Plane<float>, channels> mean, variance;
};

/// What is translucent is looked through, matter is met where a path would scatter first; mirrors and glass are seen themselves.
/// Throws Error(usage) for lack of memory. O(pixels).
Features features_of(const World& world, const PictureCamera& camera, const LightOptions& options, Context& context);

/// As their planes.
void keep_features(const Features& features, const Projection& projection, LightPlanes& planes);

}  // namespace sg::trace
