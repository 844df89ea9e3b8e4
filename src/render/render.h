// SPDX-License-Identifier: Apache-2.0
// Scene + Camera -> Frame.
#pragma once
#include <optional>
#include <string>

#include "base/context.h"
#include "image/image.h"
#include "render/trace/light_options.h"
#include "render/trace/progress/light_watch.h"
#include "scene/scene.h"

namespace sg {

struct RenderOptions {
  int width = 1280, height = 720;
  int samples = 0;  ///< per pixel and axis (1, 2, 3, 4); 0 = 2 for surfaces (for level sets that rays meet only where they differ, as
                    ///< below), 1 for volumes alone
  /// Above 0: take all samples only where neighbouring pixels, at one sample each, differ by more than this share of full scale in a
  /// channel (as displayed) or show different items; decided for squares of 16/samples pixels.
  double adaptive = 0;
  /// Volumes larger than memory: largest number of pixels that a voxel may cover (data/bricked.h). 0: draw only from the level in memory.
  double coarser = 1;
  std::optional<LightOptions> light;  ///< by paths of light instead of the rasterizer; samples and adaptive do not count then
  LightWatch watch;                   ///< with light: gets the picture while it is drawn
};

/// Throws Error(usage) when the frames of a picture of that size, and the image made from them, exceed the memory allowed
/// (data/memory/memory_budget.h).
void check_picture_memory(int width, int height, int frames);

/// Surfaces, lines, points and volumes in one picture: opaque ones by depth, translucent ones and volumes in depth order,
/// over the background. The same bytes for any number of threads and any SIMD target.
/// `report`: with options.light, what it took.
Frame render(const Scene& scene, const Camera& camera, const RenderOptions& options, Context& context, TraceReport* report = nullptr);

/// "21 paths a pixel on average, standard error 0.0131 of full scale"
std::string light_text(const TraceReport& report);

}  // namespace sg
