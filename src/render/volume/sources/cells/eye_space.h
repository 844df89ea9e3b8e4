// SPDX-License-Identifier: Apache-2.0
// EyeSpace: the vertices of a CellVolume as a picture sees them, and the lines of its pixels among them.
#pragma once
#include <array>
#include <vector>

#include "render/volume/sources/cells/cell_volume.h"

namespace sg::volume {

/// A ray is where x = (eye x - x0) - dx * depth is 0, and the same for y.
struct alignas(64) RayLines {
  static constexpr int lanes = 16;
  float x0[lanes], y0[lanes], dx[lanes], dy[lanes];
};

struct TileBox {
  int x0, y0, x1, y1;  ///< of tiles, inclusive
};

/// Depths here are relative to that of the mesh's middle.
class EyeSpace {
 public:
  EyeSpace(const CellVolume& volume, const Projection& projection, Context& context);
  /// x, y, depth and stored value (0 for cell fields) of a vertex.
  const float* operator[](uint32_t vertex) const { return &vertices_[4 * size_t(vertex)]; }
  double middle_depth() const { return middle_depth_; }
  float near_depth() const { return float(projection_.near_plane - middle_depth_); }
  float far_depth() const { return float(projection_.far_plane - middle_depth_); }
  /// The line of pixel coordinates (px, py); x0, dx depend on px alone, y0 and dy on py.
  void line(RayLines& lines, int lane, double px, double py) const;
  /// Ray length per depth.
  float length(const RayLines& columns, int column, const RayLines& rows, int row) const {
    const float x = columns.dx[column], y = rows.dy[row];
    return projection_.parallel ? 1.0f : std::sqrt(1 + x * x + y * y);
  }
  /// Tiles of this many pixels that the projection of the vertices may touch; all when it is cut by the plane of the eye.
  template <size_t N>
  TileBox tiles(const std::array<uint32_t, N>& vertices, int size, int across, int down) const;

 private:
  Projection projection_;
  double middle_depth_ = 0;
  Plane<float> vertices_;
};

/// Lists of boxes by tile, ascending: first[t] .. first[t + 1] in `places`.
void bin_boxes(const std::vector<TileBox>& boxes, int across, int down, std::vector<uint32_t>& first, std::vector<uint32_t>& places);

/// Barycentric weights of x (relative to TetMesh::origin).
inline void tet_weights(const TetMesh& m, size_t tet, Vec3 x, double w[4]) {
  const auto& v = m.corners[tet];
  const Vec3 a = m.at[v[0]], p = m.at[v[1]] - a, q = m.at[v[2]] - a, r = m.at[v[3]] - a, d = x - a;
  const double per = 1 / dot(p, cross(q, r));
  w[1] = dot(d, cross(q, r)) * per, w[2] = dot(p, cross(d, r)) * per, w[3] = dot(p, cross(q, d)) * per;
  w[0] = 1 - w[1] - w[2] - w[3];
}

}  // namespace sg::volume
