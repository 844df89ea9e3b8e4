// SPDX-License-Identifier: Apache-2.0
// CellProbe: one cell of any type against a point or a ray, by the rules that locators, probing and resampling share.
//
// A solid cell holds a point that is outside by at most 1e-9 in reference (barycentric) units. Points, curves and surfaces hold a point
// within `slack` of them. A triangle of a ray test takes its corners in the order of their ids, so that two cells that share a face are
// hit at the very same t.
#pragma once
#include <vector>

#include "data/cells/shape/cell_map.h"
#include "data/dataset.h"

namespace sg {

constexpr double locate_tolerance = 1e-9;

/// Linear tetrahedra and triangles straight from the arrays; plain data, shared by all threads.
struct SimplexArrays {
  const float* f32 = nullptr;  ///< packed positions, one of the two
  const double* f64 = nullptr;
  Vec3 origin{0, 0, 0};
  CellsView cells;
  size_t first = 0;                ///< number of the first cell of the list (a surface's polygons)
  const uint8_t* types = nullptr;  ///< null when all are `single`
  CellType single = CellType::empty;
  Array keep;       ///< owns the packed positions
  double ease = 0;  ///< what doubles leave uncertain of a position, times 4: see tetra_tolerance

  SimplexArrays() = default;
  explicit SimplexArrays(const Dataset& dataset);

  /// tetra, triangle, or empty for anything else.
  CellType type(size_t cell) const {
    if (cell - first >= cells.count) return CellType::empty;
    const CellType t = types ? CellType(types[cell]) : single;
    return t == CellType::tetra || t == CellType::triangle ? t : CellType::empty;
  }
  /// All cells are of this one type: no look at the type is needed.
  bool all(CellType t) const { return !types && single == t; }
  int64_t id(size_t cell, int k) const { return cells.connectivity[cells.begin(cell - first) + size_t(k)]; }
  Vec3 point(int64_t id) const {
    if (f32) return {origin.x + double(f32[3 * id]), origin.y + double(f32[3 * id + 1]), origin.z + double(f32[3 * id + 2])};
    return {origin.x + f64[3 * id], origin.y + f64[3 * id + 1], origin.z + f64[3 * id + 2]};
  }
};

/// Barycentric coordinates of b, c, d; not finite for a flat tetrahedron.
inline Vec3 tetra_coordinates(Vec3 x, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vec3 u = b - a, v = c - a, w = d - a, p = x - a;
  const Vec3 vw = cross(v, w), wu = cross(w, u), uv = cross(u, v);
  const double scale = 1 / dot(u, vw);
  return Vec3(dot(p, vw), dot(p, wu), dot(p, uv)) * scale;
}
inline bool in_tetra(Vec3 r, double tolerance) {
  return (r.x >= -tolerance) & (r.y >= -tolerance) & (r.z >= -tolerance) & (r.x + r.y + r.z <= 1 + tolerance);
}
/// locate_tolerance, and far from zero what rounding of positions amounts to in a tetrahedron with this edge.
inline double tetra_tolerance(double ease, Vec3 edge) {
  return locate_tolerance + ease / (std::abs(edge.x) + std::abs(edge.y) + std::abs(edge.z));
}

/// How far from points, curves and surfaces a point may lie to belong to them: 1e-6 of the mesh's size.
double locate_slack(const Dataset& dataset);
/// A box that holds all of the open cell, curved ones too: |x - (its corners' interpolation)| is bounded by the deviation of its nodes
/// times the Lebesgue constant of its order.
Box3 cell_box(const CellReader& reader);

/// Not thread-safe: one per thread; copies are cheap.
class CellProbe {
 public:
  /// `simplices` must outlive it; `map` is copied.
  CellProbe(const CellMap& map, const SimplexArrays& simplices, double slack) : map_(map), fast_(&simplices), slack_(slack) {}

  /// Whether the cell contains x, and where.
  bool holds(size_t cell, Vec3 x, CellPlace& place);
  /// The nearest point of the cell and its squared distance: 0 for a solid that holds x, else of its faces; of curves and
  /// surfaces by their map. Infinity where that is more than `limit2` for sure, which spares the look at curved cells far away.
  double nearest(size_t cell, Vec3 x, Vec3& at, double limit2 = HUGE_VAL);
  /// Smallest t in [t0, t1] where the ray meets a face of a solid or a 2D cell; NaN for none. `normal`: unit; of a solid: outward.
  double hit(size_t cell, Vec3 x, Vec3 d, double t0, double t1, Vec3& normal);

  /// Point ids and weights of a place that holds() found.
  void weights(size_t cell, const CellPlace& place, std::vector<int64_t>& ids, std::vector<double>& out);

  CellMap& map() { return map_; }
  /// The map with this cell open.
  CellMap& open(size_t cell) {
    if (opened_ != cell) map_.open(cell), opened_ = cell, triangles_of_ = size_t(-1);
    return map_;
  }

 private:
  void make_triangles();
  CellMap map_;
  const SimplexArrays* fast_;
  double slack_;
  size_t opened_ = size_t(-1), triangles_of_ = size_t(-1);
  std::vector<uint32_t> triangles_, part_, ring_;  // places in the open cell's ids(), three a triangle
  std::vector<Vec3> corners_, face_;               // positions of the open cell's nodes; Bezier: on the cell
};

}  // namespace sg
