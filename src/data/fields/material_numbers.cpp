// SPDX-License-Identifier: Apache-2.0
#include "data/fields/material_numbers.h"

#include <cmath>

namespace sg {

const Field* material_numbers(const Dataset& d) {
  for (const Field& f : d.fields())
    if (f.materials && f.association == Association::cell && f.components() == 1) return &f;
  return nullptr;
}

int64_t material_number(const Field& numbers, size_t cell) {
  const double v = numbers.array.get(cell);
  return v == v && std::abs(v) < 1e15 ? int64_t(v) : 0;
}

}  // namespace sg
