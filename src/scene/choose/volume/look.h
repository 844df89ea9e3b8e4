// SPDX-License-Identifier: Apache-2.0
// Opacity (and for CT the colours) of a volume when nobody says: read off the histogram.
#pragma once
#include <string>

#include "base/context.h"
#include "scene/choose/coloring.h"
#include "scene/items/volume_item.h"

namespace sg {

// With a communicator in the context all pieces of a volume on other ranks count too, and each rank calls with its own.

/// CT of a body: 16-bit integers with an air peak at the low end and a range of soft tissue and bone. `offset`: what to add
/// to Hounsfield units to get values (0 or 1024).
bool looks_like_ct(const Dataset& data, const Field& field, double* offset, const Context& context = Context());

/// Fills item.opacity (and item.color for CT when map is auto, unless `anatomy` is false); returns one line that says what was chosen and
/// why.
std::string choose_volume_look(const Dataset& data, const Field& field, const ColoringParams& params, VolumeItem& item, bool anatomy = true,
                               const Context& context = Context());

}  // namespace sg
