// SPDX-License-Identifier: Apache-2.0
// Medium: extinction as cubics over the value, on as few knots as their accuracy allows, and colour as a fine table: one over all values,
// or, where colours jump, one for each line between two knots.
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
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
    double faint = 0.01;       ///< a tau too small to matter
    double most_tau = 1e6;     ///< represents the tau of opacity 1, which has none; more of it where few values have it
  };
  /// Samples -log(1 - opacity)/unit until cubics between the knots are right to the accuracy. Every point of the curve is a knot, and so
  /// are jumps of colour and stops that are close together. Values that the scale does not draw have tau 0. Opacities below 1 keep their
  /// own tau, at most 37 / unit.
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
  float unit() const { return unit_; }  ///< world length to which opacity refers
  float per_unit() const { return per_unit_; }
  /// Error of Simpson's rule, times 120, in the mean of tau per length where the value is a parabola or a cubic: it is exact only where tau
  /// is linear over the value, but where opacity does the second derivative of tau is unit slope^2, the third 2 unit^2 slope^3. `slope` is
  /// that of tau, the value changes by `range`; `bend` is its half second derivative, `twist` the factor of its third power, over the
  /// stretch. A ramp of opacity that is crossed on a small part of the stretch bends no more than from 0 to 1 there.
  float leaning(float slope, float range, float bend, float twist) const {
    const float per_opacity = std::min(slope * unit_, 1e30f);
    const float y = std::min(per_opacity * range, 1.0f), u = std::min(per_opacity * bend, 1.0f), w = std::min(per_opacity * twist, 1.0f);
    return per_unit_ * (u * (0.5f * u + y * y) + w * y);
  }
  float top() const { return top_; }      ///< largest value in the data
  float faint() const { return faint_; }  ///< a tau too small to matter
  Vec3f color(float v) const { return pieced() ? color(v, line_of(v)) : color_of_node(size_t(node(v))); }
  /// On a line, its ends included: at a knot colours may jump.
  Vec3f color(float v, int line) const {
    if (!pieced()) return color_of_node(size_t(node(v)));
    const ColorPiece& p = pieces_[size_t(line)];
    const float at = (axis(v) - p.lo) * p.per + 0.5f;
    return color_of_node(size_t(p.first + (at > 0 ? at < p.count ? std::floor(at) : p.count : 0)));
  }
  Optics at(float v) const {
    const int i = line_of(v);
    return {lines_[size_t(i)](v), color(v, i)};
  }

  /// Whether tau or colour jumps, or changes within so small a range of values that it is practically a jump, between two lines that meet
  /// in (lo, hi). Then integrals must know where a ray meets the knots.
  bool abrupt(float lo, float hi) const {
    return any_abrupt() && abrupt_before_[size_t(line_of(hi))] != abrupt_before_[size_t(line_of(lo))];
  }
  bool any_abrupt() const { return abrupt_before_.back() > 0; }
  /// By lines: such knots at their lower ends and below.
  const int32_t* abrupt_before() const { return abrupt_before_.data(); }
  /// Whether the lower end of a line is such a knot of colour.
  bool recolors(size_t line) const { return recolors_[line] != 0; }

  /// All of it as straight lines, over the values in the data, for integration over the value itself.
  struct Straight {
    float lo, hi;
    Optics at, slope;  ///< at lo, and per value
  };
  std::vector<Straight> straight() const;

  /// Whether tau is zero on all of [lo, hi].
  bool clear(float lo, float hi) const { return !(lo <= hi) || most(columns_.most_tau, lo, hi) == 0; }
  /// Largest tau and largest |d tau/d v| over [lo, hi].
  float most_tau(float lo, float hi) const { return most(columns_.most_tau, lo, hi); }
  float most_slope(float lo, float hi) const { return most(columns_.most_slope, lo, hi); }

  /// Colours lie evenly on an axis: the value itself, or on log and symlog scales a piecewise-linear logarithm read off the bits of the
  /// float. A change of the axis by `color_width` bends them by less than the accuracy.
  float axis(float v) const {
    if (kind_ == ScaleKind::linear) return v;
    v += base_;
    if (kind_ == ScaleKind::log) return v > 0 ? bit_log(v, log_zero_) : -1e30f;
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
  /// Of a line: its nodes from number `first` on, `count` + 1 of them, the first at `lo` on the axis.
  struct ColorPiece {
    float lo, per, first, count;
  };
  bool pieced() const { return !pieces_.empty(); }  ///< whether each line has nodes of its own
  const ColorPiece* pieces() const { return pieces_.data(); }
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
  // log2 with straight lines between the powers of two: monotone, continuous, exactly invertible. 0 for the power of two 2^zero.
  static float bit_log(float v, int zero = 0) { return float(std::bit_cast<int32_t>(v) - 0x3F800000 - (zero << 23)) * 0x1p-23f; }
  Vec3f color_of_node(size_t n) const {
    const uint16_t* c = &colors_[4 * n];
    return {float(c[0]) * (1.0f / 65535), float(c[1]) * (1.0f / 65535), float(c[2]) * (1.0f / 65535)};
  }
  double value_on_axis(double a) const;
  using Spans = std::vector<Vec2>;  // from, to: the lines in double
  Spans make_lines(const ColorScale& scale, const OpacityCurve& curve, const Plan& plan);
  void make_colors(const ColorScale& scale, const Plan& plan);
  void piece_colors(const ColorScale& scale, const Spans& spans);
  void find_abrupt(const ColorScale& scale, const Spans& spans);
  void bound();
  void slice();
  float most(const std::vector<float>& table, float lo, float hi) const;

  std::vector<Line> lines_;
  std::vector<uint16_t> first_;  // by equal slices of the value (and beyond them): the line in which the slice begins
  float slice_lo_ = 0, per_slice_ = 0;
  float top_ = 0, accuracy_ = 0, faint_ = 0, unit_ = 1, per_unit_ = 1;  // largest value; of the plan
  Columns columns_;
  std::vector<int32_t> abrupt_before_;
  std::vector<uint8_t> recolors_;
  std::vector<ColorPiece> pieces_;
  bool abrupt_colors_ = false;

  ScaleKind kind_ = ScaleKind::linear;
  int log_zero_ = 0;  // exponent of the low end of a log scale: fields scaled by powers of two have the same axis
  std::vector<uint16_t> colors_;
  float base_ = 0, per_threshold_ = 1, first_node_ = 0, per_node_ = 0, color_width_ = 1, color_slope_ = 0;
};

}  // namespace sg::volume
