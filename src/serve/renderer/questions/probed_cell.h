// SPDX-License-Identifier: Apache-2.0
// The cell under the pointer.
#pragma once
#include <cstdint>
#include <optional>

#include "base/context.h"
#include "data/dataset.h"

namespace sg::serve {

/// The cell that holds a place of the picture, or which is as good as there: on surfaces, and where rounding has moved the place out of the
/// mesh, the nearest of those around it. Nothing for point clouds, and where no cell is.
std::optional<size_t> probed_cell(const DatasetPtr& data, Vec3 at, Context& context);

}  // namespace sg::serve
