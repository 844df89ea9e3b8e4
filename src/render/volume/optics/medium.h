// SPDX-License-Identifier: Apache-2.0
// Medium: extinction and colour as piecewise-linear functions of the value, on as few knots as their accuracy allows.
#pragma once
#include <vector>

#include "color/color_scale.h"

namespace sg::volume {

/// Emission and absorption (Max 1995): extinction tau per world length, straight colour c in linear light. C = integral of
/// c tau exp(-integral tau).
struct Optics {
  float tau, r, g, b;
};

/// tau(v) and c(v): linear between knots, constant beyond the first and last. Two knots at one value make a step (the upper one
/// holds at the value itself). Values are stored ones (value - base).
class Medium {
 public:
  struct Knot {
    float value;
    Optics at;
  };

  /// Samples -log(1 - opacity)/unit and the colour scale until straight lines between the knots are right to `accuracy`: of the
  /// colour in absolute terms, of the opacity over one unit of length too. Every point of the curve is a knot. tau is at most
  /// `most_tau` (opacity 1 has none). Out-of-range values that the scale does not draw have tau 0.
  Medium(const ColorScale& scale, const OpacityCurve& curve, double unit, double lo, double hi, float base, double accuracy,
         double most_tau);

  const std::vector<Knot>& knots() const { return knots_; }
  /// i with knots[i].value <= v < knots[i+1].value; -1 below the first, size-1 from the last on. Constant time.
  int interval(float v) const;
  Optics at(float v) const;
  /// Is tau zero on all of [lo, hi]?
  bool clear(float lo, float hi) const;
  /// Largest tau over [lo, hi], and the largest slopes |d tau/d v| and |d c/d v| there.
  float most_tau(float lo, float hi) const;

 private:
  std::vector<Knot> knots_;
  std::vector<uint16_t> first_;  // by equal slices of the value: the interval in which the slice begins
  float slice_lo_ = 0, per_slice_ = 0;
  std::vector<uint32_t> clear_before_;
};

}  // namespace sg::volume
