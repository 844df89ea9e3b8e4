// SPDX-License-Identifier: Apache-2.0
// SurfaceWalk: lines of a vector field from triangle to triangle of a surface.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "filter/flow/texture/refined_surface.h"

namespace sg {

/// Walks a surface with vectors on its points (linear in each triangle) or its triangles; keeps a reference to the surface. Only the part
/// of a vector along the triangle counts. Crossing an edge, a line goes on by the neighbour's own vectors: what unfolding both triangles
/// would give for a field that is continuous along the surface.
class SurfaceWalk {
 public:
  /// A place on the surface in barycentric coordinates.
  struct Place {
    uint32_t triangle = 0;
    std::array<double, 3> b{1, 0, 0};
    int from = -1;  ///< the corner opposite the edge that the line came in by
  };

  SurfaceWalk(const RefinedSurface& surface, std::span<const Vec3> vectors, bool per_triangle);

  Place start(uint32_t triangle, uint32_t point) const;
  /// Goes `length` along the field (sign 1) or against it (-1); false when the line ends before, `at` is then where it ended.
  bool advance(Place& at, double length, double sign) const;
  Vec3 position(const Place& at) const;

 private:
  using Rates = std::array<double, 3>;
  /// A triangle with the edges e1, e2 from its first corner: the vectors of its corners along it as u e1 + w e2, and the products of the
  /// edges.
  struct Frame {
    double u[3], w[3];
    double a, b, c;  // e1.e1, e1.e2, e2.e2
    double least2;   // square of the length below which there is no direction
  };
  struct Along {
    double u, w, length2;
  };
  static Along along(const Frame& f, const std::array<double, 3>& b);
  Frame frame(size_t triangle, std::span<const Vec3> vectors, bool per_triangle) const;
  /// Change of the barycentric coordinates per length; false without direction.
  static bool rates(const Frame& f, const std::array<double, 3>& b, double sign, Rates& d);
  bool cross(Place& at, int edge) const;
  /// Rates along the edge opposite a corner, for fields that run into it from both sides.
  static bool slide(const Frame& f, const Place& at, int corner, double sign, Rates& d);

  const RefinedSurface& surface_;
  std::vector<Frame> frames_;
};

}  // namespace sg
