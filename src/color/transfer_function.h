// SPDX-License-Identifier: Apache-2.0
// TransferDetail: what a volume's opacity and colour depend on besides the value of its field; TransferFunction: all of it, evaluated.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "color/color_scale.h"
#include "color/widgets/transfer_widget.h"
#include "color/widgets/widget_regions.h"

namespace sg {

/// The second axis of a transfer function. n is the unit gradient, g its length before, H the symmetric matrix of second derivatives,
/// all of the field in world space, so that pictures do not depend on how finely a field is sampled.
enum class SecondAxis {
  none,
  gradient,           ///< magnitude of the gradient, value per world length
  second_derivative,  ///< along the gradient: n . H n (Kindlmann, Durkin 1998)
  curvature,          ///< mean curvature of the level set, 1/length (Kindlmann et al. 2003)
  field,              ///< the value of another field at the same place
};

/// Opacity = curve(value) * second_factor(second), or the largest of the widgets when there are any.
struct TransferDetail {
  SecondAxis second = SecondAxis::none;
  std::string second_field;      ///< for SecondAxis::field: a point field of the same dataset
  bool color_by_second = false;  ///< colour follows the second axis through `second_color`, opacity the value
  ColorScale second_color;
  OpacityCurve second_factor{{{0, 1}}};  ///< factor in [0,1] over the second axis
  std::vector<TransferWidget> widgets;
  double second_lo = 0, second_hi = 1;  ///< part of the second axis that legends show

  bool plain() const { return second == SecondAxis::none && widgets.empty(); }
};

/// Second derivatives of a scalar field at a place.
struct SecondDerivatives {
  float xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
};

/// n . H n: the second derivative along the gradient (Kindlmann, Durkin 1998); 0 where the gradient vanishes. Across the border of two
/// materials it goes from positive over 0 in the middle to negative.
inline float second_derivative_along(Vec3f gradient, const SecondDerivatives& h) {
  const float gg = dot(gradient, gradient);
  if (!(gg > 0)) return 0;
  const Vec3f hg{h.xx * gradient.x + h.xy * gradient.y + h.xz * gradient.z, h.xy * gradient.x + h.yy * gradient.y + h.yz * gradient.z,
                 h.xz * gradient.x + h.yz * gradient.y + h.zz * gradient.z};
  return dot(gradient, hg) / gg;
}

/// Mean curvature (k1 + k2)/2 of the level set through a place, -div(n)/2 = (n . H n - trace H) / (2 g) (Kindlmann, Whitaker, Tasdizen,
/// Moeller 2003): positive where the larger values bulge out, 1/R on a ball of radius R of larger values; 0 where the gradient vanishes.
inline float mean_curvature(Vec3f gradient, const SecondDerivatives& h) {
  const float g = length(gradient);
  if (!(g > 0)) return 0;
  return (second_derivative_along(gradient, h) - (h.xx + h.yy + h.zz)) / (2 * g);
}

/// Straight lines between points, read in constant time: points within a slice of the axis are few.
class FastCurve {
 public:
  /// Points as in OpacityCurve; values are stored ones plus `base`.
  FastCurve(const OpacityCurve& curve, double base);
  float at(float x) const {
    if (!(x >= x_.front())) return x == x ? y_.front() : 0;
    if (x >= x_.back()) return y_.back();
    size_t i = first_[std::min(size_t((x - x_.front()) * per_slice_), first_.size() - 1)];
    while (x >= x_[i + 1]) ++i;
    return y_[i] + slope_[i] * (x - x_[i]);
  }
  /// Zero on all of [lo, hi]?
  bool zero(float lo, float hi) const;
  /// Largest value over [lo, hi].
  float most(float lo, float hi) const;
  /// Length of the shortest line; infinite when there is none.
  float narrow() const;
  /// Whether a line shorter than this reaches into [lo, hi].
  bool shorter_line(float lo, float hi, float length) const;
  /// Where it jumps, or begins to be more than zero.
  using Edge = OpacityEdge;
  std::vector<Edge> edges() const;

 private:
  size_t after(float x) const;  // points at or below x
  std::vector<float> x_, y_, slope_;
  std::vector<uint32_t> first_, positive_before_;
  float per_slice_ = 0;
};

/// Colour and opacity of (value, second), from tables: no search, no transcendental function per sample (but for labels).
class TransferFunction {
 public:
  /// Straight colour in linear light, and opacity per unit length.
  struct Sample {
    float r, g, b, opacity;
  };

  /// Values are stored value + base; the second axis is never shifted. Values that `scale` leaves out (not clamped) have opacity 0.
  /// Throws Error(usage) as color_table() does, and for detail.color_by_second without a second axis.
  TransferFunction(const ColorScale& scale, const OpacityCurve& opacity, const TransferDetail& detail, double base = 0);

  /// NaN of either that matters gives opacity 0.
  Sample at(float value, float second) const {
    float color[4];
    const float opacity = opacity_and_color(value, second, color);
    return {color[0], color[1], color[2], opacity};
  }
  float opacity(float value, float second) const {
    if (!(value >= drawn_lo_ && value <= drawn_hi_)) return 0;
    if (!widgets_.empty()) return widgets_.at(value, second, {}, nullptr);
    return with_factor_ ? curve_.at(value) * factor_.at(second) : curve_.at(value);
  }
  /// Whether opacity is 0 for every value in [lo, hi] (stored), whatever the second axis. Never wrongly true; false at times for
  /// intervals that only touch what is drawn.
  bool clear(float lo, float hi) const;
  /// Upper bound on opacity over [lo, hi], whatever the second axis.
  float most_opacity(float lo, float hi) const;
  /// Samples nearer to each other than this, over the value and over the second axis, miss no line of a curve and no widget.
  float narrow() const { return narrow_; }
  float narrow_second() const { return narrow_second_; }
  /// Whether samples this far apart can miss a line of the curve or a widget that reaches into [lo, hi]. Over the value, and over the
  /// second axis.
  bool misses(float lo, float hi, float apart) const;
  bool misses_second(float lo, float hi, float apart) const;
  /// Where opacity jumps or begins to be more than zero, over the (stored) value and over the second axis; by how much at most.
  using Edge = FastCurve::Edge;
  const std::vector<Edge>& edges() const { return edges_; }
  const std::vector<Edge>& second_edges() const { return second_edges_; }

 private:
  // From a value to its place in a table of colours.
  struct Colors {
    Colors(const ColorScale& scale, double base);
    Vec4f at(float v) const;
    float axis(float v) const;
    double value_on_axis(double a) const;
    ColorScale scale;
    double base;
    float first = 0, per_axis = 0, per_threshold = 1;
    std::vector<Vec4f> table;
    Vec4f below, above, nan;
  };
  float opacity_and_color(float value, float second, float color[4]) const;

  Colors colors_;
  FastCurve curve_, factor_;
  bool with_factor_ = false, color_by_second_ = false;
  std::vector<Colors> second_colors_;  // none or one
  WidgetRegions widgets_;
  float most_factor_ = 1, drawn_lo_, drawn_hi_, narrow_ = HUGE_VALF, narrow_second_ = HUGE_VALF;
  std::vector<Edge> edges_, second_edges_;
};

}  // namespace sg
