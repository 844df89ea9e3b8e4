// SPDX-License-Identifier: Apache-2.0
// SurfaceWalk: lines of a vector field from triangle to triangle of a surface; SurfaceAxisWalk: of the eigenvectors of a tensor field.
#pragma once
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "filter/flow/texture/surface/refined_surface.h"
#include "filter/flow/texture/surface/surface_directions.h"

namespace sg {

/// Walks a surface with vectors (tensors) on its points, linear in each triangle, or its triangles; keeps a reference to the surface. Only
/// their part along the triangle counts. Crossing an edge, a line continues with the neighbour's own directions: what unfolding both
/// triangles would give for a field that is continuous along the surface. Directions without a sign take the one nearer to the way the line
/// goes, which is carried across edges by unfolding them.
template <class Directions>
class SurfaceWalker {
 public:
  using Rates = std::array<double, 3>;  ///< change of the barycentric coordinates per length
  /// A place on the surface in barycentric coordinates, and the straight piece of line that begins there.
  struct Place {
    uint32_t triangle = 0;
    std::array<double, 3> b{1, 0, 0};
    int from = -1;             ///< the corner opposite the edge that the line came in by
    double ahead[2] = {0, 0};  ///< directions without a sign: the way the line goes, by the triangle's edges; 0 at the start
    Rates along{};
    double left = 0, sign = 0;  ///< of the piece; 0: the next one is not known yet
    int edge = -1;              ///< where it ends; -1: inside the triangle
  };

  /// `longest`: of a piece of line, in triangles that are larger.
  SurfaceWalker(const RefinedSurface& surface, std::span<const typename Directions::Value> values, bool per_triangle,
                double longest = HUGE_VAL);

  Place start(uint32_t triangle, uint32_t point) const;
  /// Goes `length` along the field (sign 1) or against it (-1); false when the line ends before, `at` is then where it ended. Directions
  /// without a sign: 1 and -1 are the two ways from the start.
  bool advance(Place& at, double length, double sign) const;
  Vec3 position(const Place& at) const;

 private:
  using Frame = typename Directions::Frame;
  Frame frame(size_t triangle, std::span<const typename Directions::Value> values, bool per_triangle) const;
  void set_links();
  /// A way from `b`, of any speed; false without direction.
  static bool way(const Frame& f, const std::array<double, 3>& b, const double (&ahead)[2], double sign, Rates& d, double& speed);
  /// The next piece; false without direction.
  bool aim(Place& at, double sign, double nothing) const;
  bool cross(Place& at, int edge) const;
  /// The way the line goes after unfolding the triangles `f` and `g` at an edge, given by its ends in both.
  static void unfold(const Frame& f, const Frame& g, const size_t (&ends)[2][2], double (&ahead)[2]);
  /// Turns rates into those along the edge opposite a corner, for fields that run into it from both sides.
  static bool slide(const Frame& f, int corner, Rates& d);

  const RefinedSurface& surface_;
  double longest_;
  std::vector<Frame> frames_;
  std::vector<uint32_t> links_;  // behind each corner's opposite edge: 8 * triangle + 4 when both turn alike + the corner opposite there
};

using SurfaceWalk = SurfaceWalker<VectorDirections>;
using SurfaceAxisWalk = SurfaceWalker<AxisDirections>;
extern template class SurfaceWalker<VectorDirections>;
extern template class SurfaceWalker<AxisDirections>;

}  // namespace sg
