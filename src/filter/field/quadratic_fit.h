// SPDX-License-Identifier: Apache-2.0
// Derivatives from scattered neighbours: a weighted least-squares parabola through what lies around a place.
#pragma once
#include <span>
#include <vector>

#include "base/vec.h"

namespace sg {

/// Values and places around a point. Fits f(p + d) - f(p) = g.d + d.H d / 2 with weights 1/|d|^2 in the space that the neighbours
/// span (`dimension` 1, 2 or 3; for 2 the plane across `normal`), by Householder QR. Exact for quadratic functions; gradients of
/// smooth functions are of second order, Hessians of first. With too few or badly placed neighbours for a parabola it fits a plane
/// (exact for linear functions), and says so. Not thread-safe: one per thread.
class QuadraticFit {
 public:
  /// Sets the geometry: factorises once, for any number of fields.
  void place(std::span<const Vec3> offsets, int dimension, Vec3 normal);
  /// Derivatives of one field; `differences` are f(neighbour) - f(here), none of them NaN.
  void solve(std::span<const double> differences, Vec3& gradient, double hessian[6]) const;
  /// False: a plane was fitted, Hessians are NaN.
  bool quadratic() const { return quadratic_; }
  /// Neighbours that a parabola needs.
  static size_t needed(int dimension) { return size_t(dimension + dimension * (dimension + 1) / 2); }

 private:
  bool factorise(std::span<const Vec3> offsets, bool quadratic);
  int dimension_ = 3;
  Vec3 axis_[3];
  double scale_ = 1;
  bool quadratic_ = true;
  size_t rows_ = 0, columns_ = 0, rank_ = 0;
  std::vector<double> q_, r_, weight_;  // Householder vectors by column, R above the diagonal
  std::vector<size_t> pivot_;
  mutable std::vector<double> right_;
};

}  // namespace sg
