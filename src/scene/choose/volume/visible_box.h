// SPDX-License-Identifier: Apache-2.0
// The part of a volume in which something is seen.
#pragma once
#include <optional>

#include "color/color_scale.h"
#include "data/dataset.h"

namespace sg {

/// On a uniform or rectilinear grid: the box that holds all of the opacity but for a thousandth on each side, with a margin; along an
/// axis that it nearly fills, all of it. Nothing where that leaves out less than half of the volume, or where nothing is seen at all. Large
/// fields are sampled evenly.
std::optional<Box3> visible_box(const Dataset& data, const Field& field, int component, const OpacityCurve& opacity);

}  // namespace sg
