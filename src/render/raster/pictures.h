// SPDX-License-Identifier: Apache-2.0
// Pictures on surfaces, in the rasterizer.
#pragma once
#include "render/shade/picture_color.h"
#include "render/shade/shade.h"

namespace sg::raster {

/// Changes the colours and the light of a shaded batch of an item that has pictures: each pixel looks them up by its own footprint.
/// `pixel_scale`: pixels of this frame per pixel of the finished picture.
void draw_pictures(const PreparedItem& item, const EyeView& view, double pixel_scale, std::span<const Lamp> lamps, ShadeBatch& batch);

}  // namespace sg::raster
