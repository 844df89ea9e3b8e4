// SPDX-License-Identifier: Apache-2.0
// The open cell of a CellMap as a CellGeometry. Internal to cell_map*.cpp.
#pragma once
#include "data/cell_inverse.h"
#include "data/cell_map.h"

namespace sg {

struct CellMap::Geometry : CellGeometry {
  /// Works on the map's scratch space.
  explicit Geometry(const CellMap& m)
      : CellGeometry{m.shape_, m.reader_.at(), m.reader_.weights(), const_cast<double*>(m.n_.data()), const_cast<Vec3*>(m.dn_.data())} {}
};

}  // namespace sg
