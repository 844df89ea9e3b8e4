// SPDX-License-Identifier: Apache-2.0
// Wendland's C2 kernel of smoothed particles (1995; Dehnen, Aly 2012: no pairing).
#pragma once
#include <cmath>
#include <numbers>

namespace sg::liquid {

/// W(r) = a (1 - q/2)^4 (2q + 1), q = r/h, up to r = 2h; its integral over the plane (flat) or space is 1.
struct Kernel {
  double h, scale;
  Kernel(double width, bool flat)
      : h(width), scale(flat ? 7 / (4 * std::numbers::pi * width * width) : 21 / (16 * std::numbers::pi * width * width * width)) {}
  double reach() const { return 2 * h; }
  double value(double r) const {
    const double q = r / h, s = 1 - q / 2;
    return s > 0 ? scale * s * s * s * s * (2 * q + 1) : 0;
  }
  /// W'(r) / r, which the gradient is times the way from the other particle.
  double slope_over_r(double r) const {
    const double s = 1 - r / (2 * h);
    return s > 0 ? -5 * scale / (h * h) * s * s * s : 0;
  }
};

}  // namespace sg::liquid
