// SPDX-License-Identifier: Apache-2.0
// TransferWidget: a region of the plane (value, second axis) that a transfer function draws.
#pragma once
#include <array>
#include <vector>

#include "base/schema/enum_words.h"
#include "base/vec.h"
#include "color/color_scale.h"

namespace sg {

/// After Kniss, Kindlmann and Hansen 2001. Opacity of a triangle and a rectangle falls linearly from its middle to 0 at the sides lo and
/// hi. That of an ellipse and of paint is opacity * (1 - d^2)^2, the biweight kernel (Silverman, Density Estimation, 1986, section 3.3.2):
/// at d = 0 it bends as a Gaussian of standard deviation 1/2 does, but it ends, at d = 1, with slope 0. d is the distance to the middle of
/// the ellipse or to the painted line, where half the ellipse or the brush's radius is 1 along either axis.
struct TransferWidget {
  enum class Shape { triangle, rectangle, ellipse, paint } shape = Shape::rectangle;
  double lo = 0, hi = 1;                 ///< over the value; a triangle's base point lies in the middle, at second_lo
  double second_lo = 0, second_hi = 1;   ///< over the second axis
  double opacity = 1;                    ///< in its middle
  Vec3f color{1, 1, 1};                  ///< sRGB; negative = that of the colour scale
  std::vector<Vec2> line{};              ///< of paint: (value, second) along which the brush went; a single point is a dab
  double radius = 0, second_radius = 0;  ///< of paint: the brush, over the value and over the second axis

  /// Whether it is soft: drawn by a round brush.
  bool brushed() const { return shape == Shape::ellipse || shape == Shape::paint; }
};

constexpr auto enum_words(TransferWidget::Shape) {
  using Shape = TransferWidget::Shape;
  return std::array{Word{"triangle", Shape::triangle}, Word{"rectangle", Shape::rectangle}, Word{"ellipse", Shape::ellipse},
                    Word{"paint", Shape::paint}};
}

/// A painted stroke: its bounds are those of the line, a radius farther out. The line has a point at least.
TransferWidget painted(std::vector<Vec2> line, double radius, double second_radius, double opacity, Vec3f color);

/// Opacity over the value that no widget exceeds whatever the second axis: exact for triangles and rectangles, up to 0.03 of their opacity
/// too much for the others.
OpacityCurve bounding_curve(const std::vector<TransferWidget>& widgets);

}  // namespace sg
