// SPDX-License-Identifier: Apache-2.0
// Cells chosen by where their centres lie.
#pragma once
#include <functional>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Sets the byte of each cell to 0 whose centre, the mean of its points, fails, or which has no points; one byte a cell. `holds` is called
/// from several threads, for cells alone whose byte is not 0.
void keep_centers(const DatasetPtr& in, const std::function<bool(Vec3)>& holds, std::vector<uint8_t>& keep, Context& ctx);

}  // namespace sg
