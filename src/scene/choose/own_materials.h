// SPDX-License-Identifier: Apache-2.0
// Materials that come with the data, as those of glTF and OBJ.
#pragma once
#include "data/dataset.h"
#include "data/fields/material_table.h"

namespace sg {

/// The field of cells that numbers materials whose looks the file tells; null when there is none.
const Field* material_numbers(const Dataset& data);

/// Whether one of these looks is more than a colour, which a field of colours tells as well: it has a picture, or says what the matter is.
bool has_own_materials(const Dataset& data);

}  // namespace sg
