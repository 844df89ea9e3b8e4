// SPDX-License-Identifier: Apache-2.0
// What the middle of a pixel sees: its depth and id.
#pragma once
#include "image/image.h"
#include "render/trace/integrators/picture_camera.h"
#include "render/trace/integrators/world.h"

namespace sg::trace {

/// Pixels of a picture, numbered row by row; those of a square of 8 x 8 along a Z-curve, on which any 4 or 16 from a multiple of that on
/// are a square.
struct PixelBox {
  int x = 0, y = 0, w = 0, h = 0;

  int count() const { return w * h; }
  int column(int p) const { return x + (on_curve() ? every_other_bit(p) : p % w); }
  int row(int p) const { return y + (on_curve() ? every_other_bit(p >> 1) : p / w); }

 private:
  bool on_curve() const { return w == 8 && h == 8; }
  static int every_other_bit(int p) { return (p & 1) | (p >> 1 & 2) | (p >> 2 & 4); }
};

/// Of the nearest surface, or of a medium where half of the light is gone before it; of several media at one place, about there. Nothing is
/// changed where nothing is met. `media`: the thread's own, or null.
void see_first_met(const World& world, const PictureCamera& camera, MediaWalk* media, const PixelBox& pixels, Frame& frame);

}  // namespace sg::trace
