// SPDX-License-Identifier: Apache-2.0
// Medium: extinction as cubics over the value, on as few knots as their accuracy allows, and colour as a fine table.
#pragma once
#include <bit>
#include <cstdint>
#include <vector>

#include "base/vec.h"
#include "color/color_scale.h"

namespace sg::volume {

/// Emission and absorption (Max 1995): extinction tau per world length, straight colour c in linear light. C = integral of
/// c tau exp(-integral tau).
struct Optics {
  float tau = 0;
  Vec3f color;
};

class Medium {
 public:
  /// tau = at + slope d + curve d^2 + twist d^3, d = v - origin, for v in [lo, hi].
  struct Line {
    float lo, hi;  ///< infinite at the ends
    float origin, at, slope, curve, twist;
    bool dark() const { return at == 0 && slope == 0 && curve == 0 && twist == 0; }
    float operator()(float v) const {
      const float d = v - origin, t = at + d * (slope + d * (curve + d * twist));
      return t > 0 ? t : 0;
    }
  };

  /// How the curves are sampled.
  struct Plan {
    double unit = 1;           ///< world length to which opacity refers
    double lo = 0, hi = 1;     ///< of the values in the data, absolute; knots lie within
    float base = 0;            ///< value = stored + base
    double accuracy = 0.0005;  ///< of colours (absolute) and of tau (relative to itself, or to `faint` where it is smaller)
    double faint = 0.01;       ///< a tau that makes no difference
    double most_tau = 1e6;     ///< stands for that of opacity 1, which has none
  };
  /// Samples -log(1 - opacity)/unit until cubics between the knots are right to the accuracy. Every point of the curve is a
  /// knot, and so is every jump of colour. Values that the scale does not draw have tau 0.
  Medium(const ColorScale& scale, const OpacityCurve& curve, const Plan& plan);

  /// Lines by rising value; never empty. Line i ends where line i+1 begins.
  const std::vector<Line>& lines() const { return lines_; }
  /// The line with lo <= v < hi, in about constant time; NaN gives the first.
  int line_of(float v) const {
    if (v > 3e38f) v = 3e38f;  // the last line ends at infinity
    const float at = (v - slice_lo_) * per_slice_;
    int i = first_[size_t(at >= 0 ? at < float(slices) ? int(at) : slices : 0)];
    while (lines_[size_t(i)].hi <= v) ++i;
    return i;
  }
  float tau(float v) const { return lines_[size_t(line_of(v))](v); }
  /// d tau/d v.
  float line_slope(float v) const {
    const Line& l = lines_[size_t(line_of(v))];
    const float d = v - l.origin;
    return l.slope + d * (2 * l.curve + d * 3 * l.twist);
  }
  float top() const { return top_; }      ///< largest value in the data
  float faint() const { return faint_; }  ///< a tau that makes no difference
  Vec3f color(float v) const {
    const uint16_t* c = &colors_[4 * size_t(node(v))];
    return {float(c[0]) * (1.0f / 65535), float(c[1]) * (1.0f / 65535), float(c[2]) * (1.0f / 65535)};
  }
  Optics at(float v) const { return {tau(v), color(v)}; }

  /// The whole of it in straight lines, over the values in the data: for those who integrate over the value itself.
  struct Straight {
    float lo, hi;
    Optics at, slope;  ///< at lo, and per value
  };
  std::vector<Straight> straight() const;

  /// Is tau zero on all of [lo, hi]?
  bool clear(float lo, float hi) const { return !(lo <= hi) || most(columns_.most_tau, lo, hi) == 0; }
  /// Largest tau and largest |d tau/d v| over [lo, hi].
  float most_tau(float lo, float hi) const { return most(columns_.most_tau, lo, hi); }
  float most_slope(float lo, float hi) const { return most(columns_.most_slope, lo, hi); }

  /// Colours lie evenly on an axis: the value itself, or on log and symlog scales a piecewise-linear logarithm read off the bits of the
  /// float. A change of the axis by `color_width` bends them by less than the accuracy.
  float axis(float v) const {
    if (kind_ == ScaleKind::linear) return v;
    v += base_;
    if (kind_ == ScaleKind::log) return v > 0 ? bit_log(v) : -1e30f;
    const float m = bit_log(1 + std::abs(v) * per_threshold_);
    return v < 0 ? -m : m;
  }
  float color_width() const { return color_width_; }
  /// Largest |change of a colour| per change of the axis.
  float color_slope() const { return color_slope_; }

  /// For vector code: the lines by columns, and the largest tau and |slope| of 2^k lines from line i on, at [k * lines + i].
  struct Columns {
    std::vector<float> origin, hi, at, slope, curve, twist, most_tau, most_slope;
  };
  const Columns& columns() const { return columns_; }
  // The colours themselves (r, g, b, 0 as u16 per node), their axis, and the slices of lines.
  static constexpr int nodes = 8192, slices = 2048;
  bool linear() const { return kind_ == ScaleKind::linear; }
  const uint16_t* colors() const { return colors_.data(); }
  float first_node() const { return first_node_; }
  float per_node() const { return per_node_; }
  const uint16_t* first_lines() const { return first_.data(); }
  float slice_lo() const { return slice_lo_; }
  float per_slice() const { return per_slice_; }

 private:
  int node(float v) const {
    const float at = (axis(v) - first_node_) * per_node_ + 0.5f;
    return at >= 0 ? at < float(nodes) ? int(at) : nodes : 0;
  }
  // log2 with straight lines between the powers of two: monotone, continuous, exactly invertible. 0 for 1.
  static float bit_log(float v) { return float(std::bit_cast<int32_t>(v) - 0x3F800000) * 0x1p-23f; }
  double value_on_axis(double a) const;
  void make_lines(const ColorScale& scale, const OpacityCurve& curve, const Plan& plan);
  void make_colors(const ColorScale& scale, const Plan& plan);
  void bound();
  void slice();
  float most(const std::vector<float>& table, float lo, float hi) const;

  std::vector<Line> lines_;
  std::vector<uint16_t> first_;  // by equal slices of the value (and beyond them): the line in which the slice begins
  float slice_lo_ = 0, per_slice_ = 0;
  float top_ = 0, accuracy_ = 0, faint_ = 0;  // largest value; of the plan
  Columns columns_;

  ScaleKind kind_ = ScaleKind::linear;
  std::vector<uint16_t> colors_;
  float base_ = 0, per_threshold_ = 1, first_node_ = 0, per_node_ = 0, color_width_ = 1, color_slope_ = 0;
};

}  // namespace sg::volume
