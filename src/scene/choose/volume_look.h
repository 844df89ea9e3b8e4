// SPDX-License-Identifier: Apache-2.0
// Opacity (and for CT the colours) of a volume when nobody says: read off the histogram.
#pragma once
#include <string>

#include "scene/choose/coloring.h"
#include "scene/items/volume_item.h"

namespace sg {

/// 256 bins over [lo, hi] of one component (magnitude for -1 of several); finite values only. Large fields are sampled evenly.
std::vector<size_t> histogram(const Field& field, int component, double lo, double hi, size_t bins = 256);

/// CT of a body: 16-bit integers with an air peak at the low end and a range of soft tissue and bone. `offset`: what to add
/// to Hounsfield units to get values (0 or 1024).
bool looks_like_ct(const Dataset& data, const Field& field, double* offset);

/// From the end of the background (the most frequent low value and its surroundings) to what one value in a thousand of the others exceeds.
/// Never empty when lo < hi.
Range foreground(const Field& field, int component, double lo, double hi);

/// Fills item.opacity (and item.color for CT when map is auto, unless `anatomy` is false); returns one line that says what was chosen and
/// why.
std::string choose_volume_look(const Dataset& data, const Field& field, const ColoringParams& params, VolumeItem& item,
                               bool anatomy = true);

}  // namespace sg
