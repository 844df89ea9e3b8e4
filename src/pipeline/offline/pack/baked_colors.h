// SPDX-License-Identifier: Apache-2.0
// The pictures of a surface as colours of its points, which is what a page shows of them.
#pragma once
#include "render/prepare/prepared.h"

namespace sg::offline {

/// The item's colours with the tint of its material and what its picture shows at each point, as fine as the triangles around it. Colours
/// of cells, and those that stand for values, stay as they are.
raster::ColorSource baked_colors(const raster::PreparedItem& item);

}  // namespace sg::offline
