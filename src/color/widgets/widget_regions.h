// SPDX-License-Identifier: Apache-2.0
// WidgetRegions: colour and opacity of widgets, and what is known of them over intervals of an axis.
#pragma once
#include <cmath>
#include <vector>

#include "base/vec.h"
#include "color/widgets/soft_stroke.h"
#include "color/widgets/transfer_widget.h"

namespace sg {

/// A place on an axis of a transfer function where opacity jumps or begins to be more than zero.
struct OpacityEdge {
  float at, steep;  ///< opacity beyond it is no more than `steep` times the distance; infinite where it jumps
};

/// Values are stored ones, second axes never shifted. The strongest widget decides on opacity; colours mix by it.
class WidgetRegions {
 public:
  WidgetRegions(const std::vector<TransferWidget>& widgets, double base);
  bool empty() const { return widgets_.empty(); }

  /// Opacity, 0 for NaN. color[0..2], if not null, becomes the mixed colour in linear light where there is any; `plain` is that of the
  /// colour scale.
  float at(float value, float second, const Vec4f& plain, float* color) const;
  /// Whether opacity is 0 on all of [lo, hi], whatever the second axis. Never wrongly true.
  bool clear(float lo, float hi) const;
  /// Upper bound on opacity over [lo, hi], whatever the second axis.
  float most(float lo, float hi) const;
  /// Samples nearer to each other than this miss no widget: half its width for what falls off to both sides, all of it for what is level.
  float narrow() const { return narrow_; }
  float narrow_second() const { return narrow_second_; }
  /// Whether samples this far apart can miss a widget that reaches into [lo, hi].
  bool misses(float lo, float hi, float apart) const;
  bool misses_second(float lo, float hi, float apart) const;
  std::vector<OpacityEdge> edges() const;
  std::vector<OpacityEdge> second_edges() const;

 private:
  struct Region {
    float lo, hi, middle, per_half, second_lo, second_hi, per_height, opacity;
    float narrow, narrow_second;
    int stroke = -1;  // of those drawn by a brush: its number among strokes_
    bool triangle, own_color;
    Vec3f color;  // linear light
  };
  std::vector<Region> widgets_;
  std::vector<SoftStroke> strokes_;
  float narrow_ = HUGE_VALF, narrow_second_ = HUGE_VALF;
};

}  // namespace sg
