// SPDX-License-Identifier: Apache-2.0
// Which cells are of which of the materials that came with the data.
#pragma once
#include "data/dataset.h"
#include "data/fields/material_table.h"

namespace sg {

/// The field of cells that numbers materials whose looks the file tells; null when there is none.
const Field* material_numbers(const Dataset& data);

/// The number of a cell's material; 0 for one that is none.
int64_t material_number(const Field& numbers, size_t cell);

}  // namespace sg
