// SPDX-License-Identifier: Apache-2.0
// TransferDetail: what a volume's opacity and colour depend on besides the value of its field.
#pragma once
#include <string>
#include <vector>

#include "color/color_scale.h"

namespace sg {

/// The second axis of a transfer function.
enum class SecondAxis {
  none,
  gradient,           ///< magnitude of the gradient, value per world length
  second_derivative,  ///< along the gradient: n . H n (Kindlmann, Durkin 1998)
  curvature,          ///< mean curvature of the level set, 1/length (Kindlmann et al. 2003)
  field,              ///< the value of another field at the same place
};

/// A region of the plane (value, second) that draws something, after Kniss, Kindlmann and Hansen 2001.
struct TransferWidget {
  enum class Shape { triangle, rectangle } shape = Shape::rectangle;
  double lo = 0, hi = 1;                ///< over the value; a triangle's base point lies in the middle, at second_lo
  double second_lo = 0, second_hi = 1;  ///< over the second axis
  double opacity = 1;                   ///< in its middle; falls linearly to 0 at the sides lo and hi
  Vec3f color{1, 1, 1};                 ///< sRGB; negative = that of the colour scale
};

/// Opacity = curve(value) * second_factor(second), or the largest of the widgets when there are any.
struct TransferDetail {
  SecondAxis second = SecondAxis::none;
  std::string second_field;      ///< for SecondAxis::field: a point field of the same dataset
  bool color_by_second = false;  ///< colour follows the second axis through `second_color`, opacity the value
  ColorScale second_color;
  OpacityCurve second_factor{{{0, 1}}};  ///< factor in [0,1] over the second axis
  std::vector<TransferWidget> widgets;

  bool plain() const { return second == SecondAxis::none && widgets.empty(); }
};

}  // namespace sg
