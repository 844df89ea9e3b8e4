// SPDX-License-Identifier: Apache-2.0
// What the middle of a pixel sees: its depth and id.
#pragma once
#include "image/image.h"
#include "render/trace/integrators/picture_camera.h"
#include "render/trace/integrators/pixel_box.h"
#include "render/trace/integrators/world.h"

namespace sg::trace {

/// Of the nearest surface, or of a medium where half of the light is gone before it; of several media at one place, about there. Nothing is
/// changed where nothing is met. `media`: the thread's own, or null.
void see_first_met(const World& world, const PictureCamera& camera, MediaWalk* media, const PixelBox& pixels, Frame& frame);

}  // namespace sg::trace
