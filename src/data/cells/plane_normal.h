// SPDX-License-Identifier: Apache-2.0
// Flat data: slices, images, maps.
#pragma once
#include <optional>

#include "data/dataset.h"

namespace sg {

/// The normal of a surface whose points all lie in one plane, or of a grid of one layer, on the side of `towards`; nothing for others.
std::optional<Vec3> plane_normal(const Dataset& d, Vec3 towards = {0, 0, 1});

}  // namespace sg
