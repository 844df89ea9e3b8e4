// SPDX-License-Identifier: Apache-2.0
// What lies behind an outline that was drawn over a picture: a polygon swept along its normal, or seen from a place.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/vec.h"

namespace sg {

/// The points of space whose projection onto the polygon's plane lies in the polygon (even-odd rule). The plane is the one that fits the
/// corners best, in the sense of least squares. Without an eye all is projected along its normal, without end on both sides; with one along
/// the rays through the eye, and only what lies on the polygon's side of the eye is inside. Safe from several threads.
class LassoRegion {
 public:
  /// `corners`: x,y,z each. Throws Error(usage) for fewer than three corners, for corners on one line, and for an eye in their plane.
  LassoRegion(std::span<const double> corners, const std::optional<Vec3>& eye, std::string_view who);

  /// From the outline, measured in the polygon's plane and, with an eye, scaled by the depth: about a distance in space. Negative inside,
  /// 0 on the outline; continuous. Behind the eye the distance from it. About O(log corners): near edges are looked at first.
  double distance(Vec3 x) const;
  /// distance(x) <= 0, without a look at all corners.
  bool holds(Vec3 x) const;

 private:
  struct Edge {
    Vec2 from, along;
    double per_square;  ///< 1 / length^2; 0 for an edge without length
  };
  struct Projected {
    Vec2 at;
    double scale;  ///< lengths in space per length in the plane; 0 behind the eye
  };
  Projected project(Vec3 x) const;
  size_t row_of(double v) const;
  double least_square(Vec2 p) const;
  bool odd(Vec2 p) const;

  Vec3 origin_, u_, v_, normal_;
  std::optional<Vec3> eye_;
  double depth_ = 0;  ///< of the plane, from the eye
  std::vector<Edge> edges_;
  // Boxes around runs of edges: box i holds boxes 2 i + 1 and 2 i + 2, the last `leaves_` of them a run each.
  struct Box {
    Vec2 lo, hi;
  };
  std::vector<Box> boxes_;
  size_t leaves_ = 1;
  // Edges of each of the strips into which v is divided, one strip after the other.
  double lowest_ = 0, highest_ = 0;
  double snap_ = 0;  ///< what lies nearer to the outline than this lies on it: rounding
  std::vector<uint32_t> begin_, edge_;
};

}  // namespace sg
