// SPDX-License-Identifier: Apache-2.0
// Derivatives from scattered neighbours: a weighted least-squares parabola, or cubic, through what lies around a place.
#pragma once
#include <span>
#include <vector>

#include "base/vec.h"

namespace sg {

/// Values and places around a point. Fits f(p + d) - f(p) = g.d + d.H d / 2 with weights 1/|d|^2 in the space that the neighbours
/// span (`dimension` 1, 2 or 3; for 2 the plane across `normal`), by Householder QR. Exact for quadratic functions; gradients of
/// smooth functions are of second order, Hessians of first, where the neighbours determine them (see determined()); those of a cubic, which
/// has products of three coordinates too, are of one order more.
/// Lines and surfaces may be bent: how far neighbours lie off the plane is fitted as well, and derivatives are those along the bent
/// surface (the gradient in its tangent plane, the covariant Hessian), of the same orders although the normal is of first order only.
/// Not thread-safe: one per thread.
class QuadraticFit {
 public:
  /// Sets the geometry: factorises once, for any number of fields. No offset may be zero.
  void place(std::span<const Vec3> offsets, int dimension, Vec3 normal, bool cubic = false);
  /// The neighbours determine the cubic that was asked for.
  bool cubic() const { return rank_ == columns_ && columns_ > needed(dimension_); }

  /// The smallest sine of the angle between a column of the fit (a coordinate or a product of two) and those before it, 0 to 1, in the
  /// better of the given axes and the neighbours' principal ones, so that thin and slanting cells count like cubes. Errors grow with its
  /// inverse: two layers of neighbours cannot separate slope from curvature (0 for boxes, small for bent ones), a third can.
  double determined() const { return determined_; }
  static constexpr double well_determined = 0.15;

  /// Derivatives of one field; `differences` are f(neighbour) - f(here), none of them NaN; `hessian` (xx xy xz yy yz zz) may be null. Below
  /// well_determined those derivatives that the neighbours do not determine are taken as 0, second ones first: linear functions stay exact
  /// while linear() is true.
  void solve(std::span<const double> differences, Vec3& gradient, double* hessian);
  /// How many derivatives, or combinations of them, are taken as 0.
  size_t undetermined() {
    split_when_poor();
    return undetermined_;
  }
  /// All first derivatives are determined; all second ones are too.
  bool linear() const { return slopes_ == size_t(dimension_); }
  bool quadratic() { return undetermined() == 0; }
  /// Neighbours that a parabola needs.
  static size_t needed(int dimension) { return size_t(dimension + dimension * (dimension + 1) / 2); }
  /// Those that a cubic needs.
  static size_t needed_by_cubic(int dimension) { return needed(dimension) + size_t(dimension * (dimension + 1) * (dimension + 2) / 6); }

 private:
  static constexpr size_t most_columns = 19, most_products = 6;
  void choose_axes(std::span<const Vec3> offsets, Vec3 normal);
  void use_principal_axes(std::span<const Vec3> offsets, int dimension);
  void factorise(std::span<const Vec3> offsets);
  void fill_columns(std::span<const Vec3> offsets);
  void take_columns(size_t begin, size_t end, double smallest);
  void split_when_poor() {
    if (determined_ < well_determined && !split_) split_products();
  }
  void split_products();
  void fit_heights(std::span<const Vec3> offsets);
  void fit(double* slope, double* bend);
  void follow_surface(const double* slope, const double* bend, Vec3& gradient, double* hessian) const;

  int dimension_ = 3;
  Vec3 axis_[3];      // of the fit, then those across it
  double unit_[3];    // by which coordinates along them are multiplied; 0: no extent
  double scale_ = 1;  // mean distance
  double determined_ = 0;
  bool split_ = false, bent_ = false;
  size_t undetermined_ = 0;
  size_t rows_ = 0, columns_ = 0;
  size_t rank_ = 0, slopes_ = 0;                    // columns taken; coordinates among them
  std::vector<double> q_, weight_;                  // by column: rows of R above, the Householder vector from the diagonal on
  double r_[most_columns], beta_[most_columns];     // of the columns as taken: R's diagonal, 2/|v|^2
  double norm_[most_columns], left_[most_columns];  // length before it was scaled to 1; square of what is left of that
  size_t order_[most_columns];                      // the column taken first, second, ...
  bool taken_[most_columns];
  double products_[most_products][most_products];  // split_: rows of R of the products, rotated to orthogonal columns
  double rotation_[most_products][most_products];  //   by this
  double height_slope_[2][3], height_bend_[2][6];  // bent_: derivatives of the heights along the axes across
  std::vector<double> right_;
};

}  // namespace sg
