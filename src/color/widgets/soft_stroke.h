// SPDX-License-Identifier: Apache-2.0
// SoftStroke: how strongly a round soft brush along a line painted a place of the plane (value, second axis).
#pragma once
#include <cstdint>
#include <vector>

#include "base/vec.h"

namespace sg {

/// (1 - d^2)^2, d the distance to the line in radii of the brush. Evaluated from the line itself: a cell of a grid over the stroke knows
/// the few segments that reach it, so that a stroke of many points costs as much as a short one, and is as exact.
class SoftStroke {
 public:
  /// Points are (value, second); values are stored ones plus `base`. Radii above 0.
  SoftStroke(const std::vector<Vec2>& line, double radius, double second_radius, double base);

  /// In [0,1]; 0 on the border of the bounds and outside of them, and for NaN.
  float at(float value, float second) const;
  /// Largest over [lo, hi] of the value whatever the second axis; a line is in one piece, so that there is one for every value.
  float most(float lo, float hi) const;

  float lo() const { return lo_; }
  float hi() const { return hi_; }
  float second_lo() const { return second_lo_; }
  float second_hi() const { return second_hi_; }

 private:
  struct Segment {
    float value, second;       // where it begins
    float along, up;           // from there to its end, in radii
    float per_length_squared;  // 0 for a point
  };
  float squared(const Segment& s, float value, float second) const;
  void sort_into_cells();

  float per_radius_, per_second_radius_;
  float lo_, hi_, second_lo_, second_hi_;  // bounds
  float line_lo_, line_hi_;                // of the line over the value
  std::vector<Segment> segments_;
  // Cells in rows over the value: segments first_[c] .. first_[c + 1] of reach_.
  uint32_t columns_ = 1, rows_ = 1;
  float per_column_ = 0, per_row_ = 0;
  std::vector<uint32_t> first_, reach_;
};

}  // namespace sg
