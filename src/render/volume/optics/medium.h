// SPDX-License-Identifier: Apache-2.0
// Medium: extinction and colour as piecewise-linear functions of the value, on as few knots as their accuracy allows.
#pragma once
#include <cstdint>
#include <vector>

#include "color/color_scale.h"

namespace sg::volume {

/// Emission and absorption (Max 1995): extinction tau per world length, straight colour c in linear light. C = integral of
/// c tau exp(-integral tau).
struct Optics {
  float tau = 0, r = 0, g = 0, b = 0;
};

/// tau(v) and c(v): linear between knots, constant beyond the first and last. Two knots at one value make a step.
class Medium {
 public:
  /// The straight line of one interval: optics at `origin` plus slope times (v - origin), for v in [lo, hi].
  struct Line {
    float lo, hi;  ///< infinite at the ends
    float origin;
    Optics at, slope;
    Optics operator()(float v) const {
      const float d = v - origin;
      return {at.tau + slope.tau * d, at.r + slope.r * d, at.g + slope.g * d, at.b + slope.b * d};
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
  /// Samples -log(1 - opacity)/unit and the colour scale until straight lines between the knots are right to the accuracy. Every
  /// point of the curve is a knot. Values that the scale does not draw have tau 0.
  Medium(const ColorScale& scale, const OpacityCurve& curve, const Plan& plan);

  /// Lines by rising value; never empty. Line i ends where line i+1 begins.
  const std::vector<Line>& lines() const { return lines_; }
  /// The line with lo <= v < hi, in about constant time; NaN gives the first.
  int line_of(float v) const {
    const float at = (v - slice_lo_) * per_slice_;
    int i = first_[size_t(at >= 0 ? at < float(slices) ? int(at) : slices : 0)];
    while (lines_[size_t(i)].hi <= v) ++i;
    return i;
  }
  Optics at(float v) const { return lines_[size_t(line_of(v))](v); }
  /// Is tau zero on all of [lo, hi]?
  bool clear(float lo, float hi) const;
  /// Largest tau and largest |d tau/d v| over [lo, hi]; a step counts with what it changes.
  float most_tau(float lo, float hi) const;
  float most_slope(float lo, float hi) const;
  /// Largest |d c/d v| of a channel.
  float most_color_slope(float lo, float hi) const;

 private:
  static constexpr int slices = 2048;
  void slice();
  void bounds();
  float most(const std::vector<std::vector<float>>& table, float lo, float hi) const;

  std::vector<Line> lines_;
  std::vector<uint16_t> first_;  // by equal slices of the value (and beyond them): the line in which the slice begins
  float slice_lo_ = 0, per_slice_ = 0;
  std::vector<std::vector<float>> tau_, slope_, color_slope_;  // [k][i]: the largest of lines i .. i + 2^k
};

}  // namespace sg::volume
