// SPDX-License-Identifier: Apache-2.0
// SurfaceWalk: lines of a vector field from triangle to triangle of a surface.
#pragma once
#include <array>
#include <span>

#include "filter/flow/texture/refined_surface.h"

namespace sg {

/// Sees a surface and vectors on its points (linear in each triangle) or its triangles; keeps neither. Only the part of a vector along the
/// triangle counts. Crossing an edge, a line goes on by the neighbour's own vectors: what unfolding both triangles would give for a field
/// that is continuous along the surface.
class SurfaceWalk {
 public:
  /// A place on the surface in barycentric coordinates.
  struct Place {
    uint32_t triangle = 0;
    std::array<double, 3> b{1, 0, 0};
    int from = -1;  ///< the corner opposite the edge that the line came in by
  };

  SurfaceWalk(const RefinedSurface& surface, std::span<const Vec3> vectors, bool per_triangle)
      : surface_(surface), vectors_(vectors), per_triangle_(per_triangle) {}

  Place start(uint32_t triangle, uint32_t point) const;
  /// Goes `length` along the field (sign 1) or against it (-1); false when the line ends before, `at` is then where it ended.
  bool advance(Place& at, double length, double sign) const;
  /// The point of the triangle that is nearest in barycentric coordinates.
  uint32_t nearest(const Place& at) const {
    const auto& b = at.b;
    return surface_.triangles[at.triangle][b[0] >= b[1] && b[0] >= b[2] ? 0 : b[1] >= b[2] ? 1 : 2];
  }
  Vec3 position(const Place& at) const;

 private:
  using Rates = std::array<double, 3>;
  struct Frame;  // of a triangle: edges and the inverse of their Gram matrix
  Frame frame(uint32_t triangle) const;
  /// Change of the barycentric coordinates per length; false without direction.
  bool rates(const Frame& f, const std::array<double, 3>& b, double sign, Rates& d) const;
  bool cross(Place& at, int edge) const;
  /// Rates along the edge opposite a corner, for fields that run into it from both sides.
  bool slide(const Frame& f, const Place& at, int corner, double sign, Rates& d) const;

  const RefinedSurface& surface_;
  std::span<const Vec3> vectors_;
  bool per_triangle_;
};

}  // namespace sg
