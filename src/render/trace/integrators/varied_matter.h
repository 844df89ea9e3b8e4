// SPDX-License-Identifier: Apache-2.0
// Matter that fields and pictures make different from point to point.
#pragma once
#include <memory>

#include "render/prepare/prepared.h"
#include "render/trace/integrators/world.h"

namespace sg::trace {

/// Of an item whose pictures multiply numbers that materials are prepared for; null for others. `length`, `around`: as of Material.
std::unique_ptr<const MaterialPalette> palette_of(const raster::PreparedItem& item, double length, double around);

/// What the item's pictures make of the material and of the normal of the vertex, which has those of the whole item. Returns the shares of
/// its material there. `scale`: traced length of a world length of 1.
MaterialShares take_pictures(const raster::PreparedItem& item, const Ray& ray, const Hit& hit, const RayFootprint& footprint, double scale,
                             const MaterialPalette* palette, Vertex& v);

}  // namespace sg::trace
