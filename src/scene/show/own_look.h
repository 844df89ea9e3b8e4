// SPDX-License-Identifier: Apache-2.0
// Surfaces as the materials that came with the data look: one item for each.
#pragma once
#include <vector>

#include "base/context.h"
#include "scene/scene.h"

namespace sg {

/// `like` once for each of the materials that number the polygons of its data (has_own_materials()), with the pictures of that material and
/// what it is made of; polygons of numbers that no look is known of stay as they are. Pictures that cannot be decoded or have no
/// coordinates are left out with a warning. The parts are kept with the data.
std::vector<SurfaceItem> items_of_materials(const SurfaceItem& like, Context& context);

}  // namespace sg
