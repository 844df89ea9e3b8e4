// SPDX-License-Identifier: Apache-2.0
// Materials that come with the data, as those of glTF and OBJ.
#pragma once
#include "data/dataset.h"
#include "data/fields/material_numbers.h"

namespace sg {

/// Whether one of these looks is more than a colour, which a field of colours tells as well: it has a picture, or says what the matter is.
bool has_own_materials(const Dataset& data);

}  // namespace sg
