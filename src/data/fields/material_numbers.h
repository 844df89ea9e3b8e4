// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "data/dataset.h"
#include "data/fields/material_table.h"

namespace sg {

/// The field of cells that numbers materials whose looks the file tells; null when there is none.
const Field* material_numbers(const Dataset& data);

}  // namespace sg
