// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/cursors/surface_normal.h"

#include <algorithm>

#include "data/cells/shape/cell_shape.h"

namespace sg {

Vec3 surface_normal(const CellMap& map, Vec3 rst) {
  const CellReader& cell = map.reader();
  const auto at = cell.at();
  if (CellShape::find(cell.type(), at.size(), cell.orders())) {
    const Mat3 j = map.jacobian(rst);
    return normalize(cross(j.column(0), j.column(1)));
  }
  if (at.size() < 3) return {NAN, NAN, NAN};
  if (cell.type() == CellType::triangle_strip) {
    const size_t k = std::min(size_t(std::max(rst.z, 0.0)), at.size() - 3);
    return normalize(cross(at[k + 1] - at[k], at[k + 2] - at[k]) * (k % 2 ? -1.0 : 1.0));
  }
  Vec3 sum;
  for (size_t k = 0; k < at.size(); ++k) sum += cross(at[k] - at[0], at[(k + 1) % at.size()] - at[0]);
  return normalize(sum);
}

}  // namespace sg
