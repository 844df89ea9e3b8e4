// SPDX-License-Identifier: Apache-2.0
// Transfer: from a value to the premultiplied colour and transmittance of one step, as a table; no transcendental function per sample.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "color/color_scale.h"

namespace sg::volume {

/// exp(-x) for x >= 0 and -log(1-x) for 0 <= x < 1, from arithmetic alone: the same bits on every machine.
double exp_negative(double x);
double minus_log_one_minus(double x);

/// alpha of a segment of `length` when its opacity per unit length is given by `density` = -log(1-opacity)/unit.
inline float segment_alpha(float density, double length) { return float(1 - exp_negative(double(density) * length)); }

/// A linear transfer table, as Transfer::index reads it.
struct LinearTable {
  float first, per_axis;
  int count;
};

/// Entries 1..count sample the values between the ends of the curve and the colour scale, evenly on the scale's axis (linear,
/// or for log and symlog a piecewise-linear logarithm that is read off the bits of the float); 0 is below, count+1 above and
/// count+2 draws nothing (NaN).
class Transfer {
 public:
  /// Linear colour of one step (premultiplied) and the share of light that passes it.
  struct alignas(16) Step {
    float r, g, b, pass;
  };
  /// Straight linear colour and density (opacity 1 = 1e30).
  struct alignas(16) Medium {
    float r, g, b, density;
  };

  /// Values are stored value + base; `lo`, `hi` is their range in the data (absolute). Labels of a categorical scale keep their colours.
  Transfer(const ColorScale& scale, const OpacityCurve& curve, double unit, double step, double lo, double hi, double base);

  int index(float stored) const {
    const float at = (axis(stored) - first_) * per_axis_;
    if (stored != stored) return count_ + 2;
    if (!(at >= 0)) return 0;
    return at > float(count_) ? count_ + 1 : std::min(int(at), count_ - 1) + 1;
  }
  /// The table as kernels read it, when its axis is linear in the value.
  bool linear() const { return kind_ == ScaleKind::linear; }
  LinearTable linear_table() const { return {first_, per_axis_, count_}; }
  const Step* steps() const { return steps_.data(); }
  const Medium& medium(int index) const { return media_[size_t(index)]; }
  /// Whether values of this entry may draw something. True also for spikes of opacity too narrow for the table.
  bool draws(int entry) const { return drawn_before_[size_t(entry) + 1] != drawn_before_[size_t(entry)]; }
  /// Whether all values in [lo, hi] (stored) are between the ends, up to rounding of an entry's index.
  bool spans(float lo, float hi) const;
  /// Bit n tells whether some entry i with i / 8 % 512 = n draws, as above.
  const std::array<uint32_t, 16>& drawn_eights() const { return drawn_eights_; }
  /// Whether every value in [lo, hi] (stored) draws nothing.
  bool clear(float lo, float hi) const;

 private:
  float axis(float v) const {
    if (kind_ == ScaleKind::linear) return v;
    if (kind_ == ScaleKind::log) return v > 0 ? bit_log(v, log_zero_) : -1e30f;
    const float m = bit_log(1 + std::abs(v) * per_threshold_);
    return v < 0 ? -m : m;
  }
  float value_on_axis(double a) const;
  // log2 with straight lines between the powers of two: monotone, continuous, exactly invertible. 0 for the power of two 2^zero.
  static float bit_log(float v, int zero = 0) { return float(std::bit_cast<int32_t>(v) - 0x3F800000 - (zero << 23)) * 0x1p-23f; }

  ScaleKind kind_ = ScaleKind::linear;
  int count_ = 4096;
  int log_zero_ = 0;  // exponent of the low end of a log scale
  float first_ = 0, per_axis_ = 0, per_threshold_ = 1;
  std::vector<Step> steps_;
  std::vector<Medium> media_;
  std::vector<uint32_t> drawn_before_;  // entries before this one that draw something
  std::array<uint32_t, 16> drawn_eights_{};
};

}  // namespace sg::volume
