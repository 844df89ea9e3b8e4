// SPDX-License-Identifier: Apache-2.0
// The map of one cell from its reference element to space, and the way back. Internal to src/data.
#pragma once
#include <span>
#include <vector>

#include "data/cells/shape/cell_shape.h"

namespace sg {

/// Shape, node positions and rational weights of one cell, with scratch space for nodes.
struct CellGeometry {
  const CellShape* shape = nullptr;
  std::span<const Vec3> at;
  std::span<const double> weight;  ///< empty = all 1
  double* n;                       ///< room for a number a node
  Vec3* dn;                        ///< room for a vector a node

  /// (Rational) functions into n, and their derivatives into dn.
  void values(Vec3 rst) const;
  void functions(Vec3 rst) const;
  Vec3 position(Vec3 rst) const;
  /// Position and the columns of the Jacobian.
  Vec3 frame(Vec3 rst, Vec3 column[3]) const;
};

struct InverseResult {
  Vec3 rst{0, 0, 0};
  bool found = false;      ///< the map of rst is x
  double outside = 1e300;  ///< of rst
};

/// rst with x(rst) = x for a solid. Newton from the centre; where it leaves, stalls or ends outside although x may be inside,
/// starts from the parts of a subdivision of the reference element whose image may hold x. Inside means outside <= tolerance.
InverseResult invert_solid(const CellGeometry& g, Vec3 x, double tolerance);

/// The reference place whose image is nearest to x, on a curve or surface: samples, then Gauss-Newton inside and along the rim.
Vec3 nearest_reference(const CellGeometry& g, Vec3 x);

/// The nearest point of a triangle; `l` its barycentric coordinates.
Vec3 nearest_on_triangle(Vec3 a, Vec3 b, Vec3 c, Vec3 x, Vec3& l);
/// The nearest point of a segment; t in [0,1] along it.
Vec3 nearest_on_segment(Vec3 a, Vec3 b, Vec3 x, double& t);

/// Solves [c0 c1 c2] y = b; false for a singular matrix.
inline bool solve_columns(const Vec3 c[3], Vec3 b, Vec3& y) {
  const Vec3 c12 = cross(c[1], c[2]);
  const double det = dot(c[0], c12);
  if (!(det != 0)) return false;
  y = Vec3(dot(b, c12), dot(c[0], cross(b, c[2])), dot(c[0], cross(c[1], b))) / det;
  return true;
}

}  // namespace sg
