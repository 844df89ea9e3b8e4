// SPDX-License-Identifier: Apache-2.0
// Checks of a volume item that every source makes before it reads the data.
#pragma once
#include "data/field.h"
#include "scene/items/volume_item.h"

namespace sg::volume {

/// The field that an item shows. Throws Error(usage) for what is not a scalar field of points or cells.
const Field& field_of(const VolumeItem& item);
/// Throws Error(usage) for lengths, tolerances and levels that are invalid.
void check(const VolumeItem& item);

}  // namespace sg::volume
