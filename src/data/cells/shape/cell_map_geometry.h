// SPDX-License-Identifier: Apache-2.0
// The open cell of a CellMap as a CellGeometry, with what walking from cell to cell needs besides. Internal to cell_map*.cpp and
// to filter/flow.
#pragma once
#include "data/cells/shape/cell_inverse.h"
#include "data/cells/shape/cell_map.h"

namespace sg {

/// Null for types without a reference map.
const CellShape* shape_of(const CellMap& map);
/// Position and the columns of the Jacobian.
Vec3 frame_of(const CellMap& map, Vec3 rst, Vec3 column[3]);
/// Of polyhedra and prisms: triangles that cover the faces, counter-clockwise seen from outside, as places in ids(); face after face, two
/// fewer than a face has corners.
std::span<const uint32_t> surface_of(CellMap& map);

struct CellMap::Geometry : CellGeometry {
  /// Works on the map's scratch space.
  explicit Geometry(const CellMap& m)
      : CellGeometry{m.shape_, m.reader_.at(), m.reader_.weights(), const_cast<double*>(m.n_.data()), const_cast<Vec3*>(m.dn_.data())} {}

  friend const CellShape* shape_of(const CellMap& map) { return Geometry(map).shape; }
  friend Vec3 frame_of(const CellMap& map, Vec3 rst, Vec3 column[3]) { return Geometry(map).frame(rst, column); }
  friend std::span<const uint32_t> surface_of(CellMap& map) { return triangles_of(map); }

 private:
  static std::span<const uint32_t> triangles_of(CellMap& map) { return map.triangles(); }
};

}  // namespace sg
