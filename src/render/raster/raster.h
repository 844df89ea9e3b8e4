// SPDX-License-Identifier: Apache-2.0
// Tiled software rasterizer: opaque surfaces into the frame's planes, translucent ones and the soft edges of lines into fragments.
//
//   triangles --(SIMD: project, cull)--> small ones: straight into the visibility buffer, one 64-bit minimum per pixel
//                                    \-> large and clipped ones: binned to 64x64 tiles
//   per tile: spans of large triangles, then one shading pass over what is visible, then fragments of all that is translucent
//
// The visibility buffer holds (depth bits << 32 | primitive number) and keeps the minimum: the nearest, at equal depth the
// lowest primitive, whichever thread comes first. Coverage: 1/256 pixel vertex grid, top-left rule, integer edge functions.
#pragma once
#include <memory>

#include "base/context.h"
#include "image/image.h"
#include "render/composite/fragments.h"
#include "render/prepare/prepare.h"
#include "scene/scene.h"

namespace sg {

struct RenderTextures;  ///< see render/raster/lic/textures.h
/// Draws the surface, line and point items of the scene at the frame's size (volumes are left out). The frame comes in
/// cleared (rgba 0, depth infinity, ids 0) and gets opaque colour (alpha 1), depth and ids; the result lists what is translucent and
/// not hidden by an opaque surface. `pixel_scale`: pixels of this frame per pixel of the final picture (supersampling), for widths.
FragmentLists rasterize(const Scene& scene, const Projection& projection, double pixel_scale, Frame& frame, Context& context);
/// `textures`: those of the view, from texture_scene(); null: surfaces with a texture get that of this very frame.
FragmentLists rasterize_prepared(const PreparedScene& scene, const Projection& projection, double pixel_scale, Frame& frame,
                                 Context& context, const RenderTextures* textures = nullptr);
/// The textures of the whole view `projection` at one sample a pixel, for frames of more samples and bands of them. Null: there are none.
std::shared_ptr<const RenderTextures> texture_scene(const PreparedScene& scene, const Projection& projection, Context& context);

}  // namespace sg
