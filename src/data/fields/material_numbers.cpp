// SPDX-License-Identifier: Apache-2.0
#include "data/fields/material_numbers.h"

namespace sg {

const Field* material_numbers(const Dataset& d) {
  for (const Field& f : d.fields())
    if (f.materials && f.association == Association::cell && f.components() == 1) return &f;
  return nullptr;
}

}  // namespace sg
