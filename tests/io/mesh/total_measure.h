// SPDX-License-Identifier: Apache-2.0
// How large a mesh is.
#pragma once
#include "data/cells/shape/cell_map.h"
#include "data/dataset.h"

namespace sg::test {

/// The sum of the lengths, areas or volumes of its cells.
inline double total_measure(const DatasetPtr& d) {
  CellMap map(d);
  double sum = 0;
  for (size_t c = 0; c < d->cell_count(); ++c) map.open(c), sum += map.measure();
  return sum;
}

}  // namespace sg::test
