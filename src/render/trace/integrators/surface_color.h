// SPDX-License-Identifier: Apache-2.0
// The colour of an item where a ray met it: from its fields, as the rasterizer colours them.
#pragma once
#include "render/prepare/prepared.h"
#include "render/trace/geometry/ray.h"

namespace sg::trace {

/// Linear RGB, straight alpha with the item's opacity.
Vec4f surface_color(const raster::PreparedItem& item, const Hit& hit);

}  // namespace sg::trace
