// SPDX-License-Identifier: Apache-2.0
// The inner loops of cell projection.
#pragma once
#include "render/volume/engines/tets/tet_rays.h"

namespace sg::volume {

/// A tetrahedron over the columns of a tile: x of its vertices relative to the line of each column.
struct ColumnTet {
  static constexpr int lanes = 16;
  alignas(64) float x[4][lanes];
  float z[4], f[4];
};

/// Intersections of a tetrahedron with the lines of a row of pixels.
struct RowCut {
  alignas(64) float enter[ColumnTet::lanes], leave[ColumnTet::lanes];  ///< depths
  alignas(64) float front[ColumnTet::lanes], back[ColumnTet::lanes];   ///< values there
};

/// `y`: of the vertices relative to the line of the row. Bit k of the result: the line of column k crosses the tetrahedron. A face that
/// two tetrahedra share is crossed in both or in none, see TetWalk.
uint32_t cut_row(const ColumnTet& tet, const float y[4], RowCut& out);

/// 16 pixels: light gathered so far, and one segment for each of them; without length = nothing.
struct alignas(64) SegmentPacket {
  static constexpr int lanes = 16;
  float front[lanes], back[lanes], length[lanes];
  float r[lanes], g[lanes], b[lanes], pass[lanes];
};
/// Composites each segment behind what is there, as TetRays does.
void put_segments(const TetMedium& medium, SegmentPacket& packet);

}  // namespace sg::volume
