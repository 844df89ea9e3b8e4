// SPDX-License-Identifier: Apache-2.0
// What every source checks of a volume item before it reads the data.
#pragma once
#include "data/field.h"
#include "scene/items/volume_item.h"

namespace sg::volume {

/// The field that an item shows. Throws Error(usage) for what is no scalar field of points or cells.
const Field& field_of(const VolumeItem& item);
/// Throws Error(usage) for lengths, tolerances and levels that are none.
void check(const VolumeItem& item);

}  // namespace sg::volume
