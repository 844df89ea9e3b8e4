// SPDX-License-Identifier: Apache-2.0
// Scene + Camera -> Frame.
#pragma once
#include "base/context.h"
#include "image/image.h"
#include "scene/scene.h"

namespace sg {

struct RenderOptions {
  int width = 1280, height = 720;
  int samples = 0;  ///< per pixel and axis (1, 2, 3, 4); 0 = 2 for surfaces, 1 for volumes alone
  /// Above 0: all the samples are taken only where neighbouring pixels of one sample differ by more than this share of full scale in a
  /// channel (as displayed), or show different items; in squares of 16/samples pixels.
  double adaptive = 0;
  /// Volumes that memory does not hold: a voxel may cover so many pixels (data/bricked.h). 0: they are drawn from the level in memory
  /// alone.
  double coarser = 1;
};

/// Throws Error(usage) when the frames of a picture of that size, and the image that is made of them, are more than may be taken
/// (data/memory/memory_budget.h).
void check_picture_memory(int width, int height, int frames);

/// Surfaces, lines, points and volumes in one picture: opaque ones by depth, translucent ones and volumes in depth order,
/// over the background. The same bytes for any number of threads and any SIMD target.
Frame render(const Scene& scene, const Camera& camera, const RenderOptions& options, Context& context);

}  // namespace sg
