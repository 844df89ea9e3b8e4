// SPDX-License-Identifier: Apache-2.0
// MediumSums: extinction summed up over the value, for integrals over steps on which the value is nearly straight.
#pragma once
#include <cstdint>
#include <vector>

#include "render/volume/medium/medium.h"

namespace sg::volume {

/// Over a length s on which the value goes straight from a to b the optical depth is s (P(b) - P(a)) / (b - a) with P the integral of tau:
/// exact, whatever knots lie between. A table of equal nodes; in each tau is a straight line.
class MediumSums {
 public:
  static constexpr int nodes = 8192, levels = 14;
  /// In node i, x above its begin: P = sum + x (tau + x slope / 2).
  struct Node {
    uint32_t sum;  ///< in units of per_sum, modulo 2^32: differences are exact
    float tau, slope;
    float kinks;  ///< by how much the slope of the colours has changed at the knots up to here, all changes added up
  };
  explicit MediumSums(const Medium& medium);

  const Node* table() const { return nodes_.data(); }
  float lo() const { return lo_; }
  float width() const { return width_; }
  float per_width() const { return per_width_; }
  float per_sum() const { return per_sum_; }
  bool kinked() const { return nodes_.back().kinks > 0; }
  /// Largest |slope| of tau of 2 * 2^level nodes from the multiple of 2^level at or below a node on: [first_of(level) + (node >> level)].
  /// 1e30 where tau jumps, or has a spike narrower than some nodes; infinite where the colour jumps.
  const float* steepest() const { return steepest_.data(); }
  static constexpr int first_of(int level) { return 2 * nodes - (2 * nodes >> level); }

 private:
  void find_kinks(const Medium& medium);

  std::vector<Node> nodes_;
  std::vector<float> steepest_;
  float lo_ = 0, width_ = 1, per_width_ = 1, per_sum_ = 1;
};

}  // namespace sg::volume
