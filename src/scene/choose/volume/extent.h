// SPDX-License-Identifier: Apache-2.0
// The range of what a ray collects, where that is not the range of the field.
#pragma once
#include "scene/items/volume_item.h"

namespace sg {

/// For sum, distance and accumulate: title, unit, and (with `choose_range`) the ends of item.color: 0 to the largest column sum along the
/// axes of a grid, 0 to the diagonal; with `choose_map` a sequential map. Other ray functions: nothing.
void take_collected_range(VolumeItem& item, bool choose_range, bool choose_map);

}  // namespace sg
