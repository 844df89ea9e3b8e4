// SPDX-License-Identifier: Apache-2.0
// What the middle of a pixel sees: its depth and id.
#pragma once
#include "image/image.h"
#include "render/trace/integrators/picture_camera.h"
#include "render/trace/integrators/world.h"

namespace sg::trace {

/// Pixels of a picture.
struct PixelBox {
  int x = 0, y = 0, w = 0, h = 0;

  int count() const { return w * h; }
  int column(int p) const { return x + p % w; }  ///< of pixel p, row by row
  int row(int p) const { return y + p / w; }
};

/// Of the nearest surface, or of a medium where half of the light is gone before it; of several media at one place, about there. Nothing is
/// changed where nothing is met. `media`: the thread's own, or null.
void see_first_met(const World& world, const PictureCamera& camera, MediaWalk* media, const PixelBox& pixels, Frame& frame);

}  // namespace sg::trace
