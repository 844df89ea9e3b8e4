// SPDX-License-Identifier: Apache-2.0
// Translucent fragments, from the covers of a tile to the lists of a picture.
#pragma once
#include <vector>

#include "render/raster/marks/marks.h"
#include "render/raster/raster.h"
#include "render/raster/triangles/bins.h"

namespace sg::raster {

struct TilePixelFragment {
  uint32_t pixel;  ///< in the tile
  Fragment fragment;
};

/// The place in the frame of a pixel of a tile.
inline size_t pixel_in_frame(const PixelBox& box, uint32_t in_tile, int width) {
  return (size_t(box.y0) + in_tile / tile_size) * size_t(width) + size_t(box.x0) + in_tile % tile_size;
}

/// Sorts what covers each pixel of a tile; the first opaque cover becomes the pixel, those in front of it fragments.
std::vector<TilePixelFragment> resolve(const PreparedScene& scene, const PixelBox& box, std::vector<Cover>& covers, Frame& frame);

/// The fragments of all tiles as one list for each pixel, near to far. Throws Error(usage) above 2^32 of them.
FragmentLists collect(const std::vector<std::vector<TilePixelFragment>>& tiles, const TileGrid& grid, const Frame& frame);

}  // namespace sg::raster
