// SPDX-License-Identifier: Apache-2.0
// Tiled software rasterizer: opaque surfaces into the frame's planes, translucent ones and the soft edges of lines into fragments.
#pragma once
#include "base/context.h"
#include "image/image.h"
#include "render/fragments.h"
#include "scene/scene.h"

namespace sg {

/// Draws the surface, line and point items of the scene at the frame's size (volumes are left out). The frame comes in
/// cleared (rgba 0, depth infinity, ids 0) and gets opaque colour (alpha 1), depth and ids; the result lists what is translucent and
/// not hidden by an opaque surface. `pixel_scale`: pixels of this frame per pixel of the final picture (supersampling), for widths.
FragmentLists rasterize(const Scene& scene, const Projection& projection, double pixel_scale, Frame& frame, Context& context);

}  // namespace sg
