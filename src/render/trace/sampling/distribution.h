// SPDX-License-Identifier: Apache-2.0
// Piecewise constant densities on [0, 1) and on the unit square, sampled by inverting their sums, which are kept in double.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "base/vec.h"

namespace sg::trace {

class Distribution1D {
 public:
  struct Sample {
    float x;      ///< in [0, 1)
    float pdf;    ///< density at x; its mean over [0, 1) is 1
    size_t cell;  ///< x lies in [cell, cell + 1) / cells
    float rest;   ///< where u lies in what falls to the cell: uniform in [0, 1) again
  };

  Distribution1D() = default;
  /// Proportional to the weights, each over 1 / count of [0, 1). Without any weight above 0 it is uniform. Throws Error(usage) for no
  /// weights, and for one that is negative or not finite.
  explicit Distribution1D(std::span<const float> weights);

  size_t cells() const { return sums_.size() - 1; }
  /// Sum of the weights.
  double total() const { return total_; }
  /// O(log cells).
  Sample sample(float u) const;
  float pdf(float x) const;
  /// Of falling into a cell.
  float probability(size_t cell) const { return float(sums_[cell + 1] - sums_[cell]); }

 private:
  std::vector<double> sums_;  // normalised, from 0 to 1
  double total_ = 0;
};

/// For pictures as lights: x within a row of cells, y over rows.
class Distribution2D {
 public:
  struct Sample {
    Vec2f point;  ///< in [0, 1)^2
    float pdf;    ///< density per area of the square
  };

  /// weights[y * width + x]. Throws Error(usage) as above, and for a number of weights that is no multiple of the width.
  Distribution2D(std::span<const float> weights, size_t width);
  double total() const { return rows_.total(); }
  Sample sample(Vec2f u) const;
  float pdf(Vec2f point) const;

 private:
  std::vector<Distribution1D> in_row_;
  Distribution1D rows_;
};

}  // namespace sg::trace
