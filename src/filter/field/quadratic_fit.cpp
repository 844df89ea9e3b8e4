// SPDX-License-Identifier: Apache-2.0
#include "filter/field/quadratic_fit.h"

#include <cmath>

namespace sg {

namespace {

// Places of xx, xy, xz, yy, yz, zz.
constexpr int hessian_place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
constexpr double smallest_pivot = 1e-7;  // of the largest: below it a direction is not determined

}  // namespace

void QuadraticFit::place(std::span<const Vec3> offsets, int dimension, Vec3 normal) {
  dimension_ = dimension;
  axis_[0] = {1, 0, 0}, axis_[1] = {0, 1, 0}, axis_[2] = {0, 0, 1};
  if (dimension == 2) {  // any two axes across the normal
    const Vec3 n = normalize(normal);
    const Vec3 other = std::fabs(n.x) <= std::fabs(n.y) && std::fabs(n.x) <= std::fabs(n.z) ? Vec3{1, 0, 0}
                       : std::fabs(n.y) <= std::fabs(n.z)                                   ? Vec3{0, 1, 0}
                                                                                            : Vec3{0, 0, 1};
    axis_[0] = normalize(cross(n, other));
    axis_[1] = cross(n, axis_[0]);
  } else if (dimension == 1) {  // along the farthest neighbour
    double farthest = 0;
    for (const Vec3& d : offsets)
      if (dot(d, d) > farthest) farthest = dot(d, d), axis_[0] = normalize(d);
  }
  double sum = 0;
  for (const Vec3& d : offsets) sum += length(d);
  scale_ = offsets.empty() || sum == 0 ? 1 : sum / double(offsets.size());
  quadratic_ = offsets.size() >= needed(dimension) && factorise(offsets, true);
  if (!quadratic_) factorise(offsets, false);
}

// Columns of d/scale and its products, rows weighted by 1/|d|; QR with column pivoting. True at full rank.
bool QuadraticFit::factorise(std::span<const Vec3> offsets, bool quadratic) {
  const auto n = size_t(dimension_);
  rows_ = offsets.size(), columns_ = quadratic ? needed(dimension_) : n;
  q_.assign(rows_ * columns_, 0), r_.assign(columns_, 0), weight_.assign(rows_, 0), pivot_.resize(columns_);
  for (size_t i = 0; i < rows_; ++i) {
    double x[3];
    for (size_t a = 0; a < n; ++a) x[a] = dot(offsets[i], axis_[a]) / scale_;
    weight_[i] = scale_ / length(offsets[i]);
    size_t c = 0;
    for (size_t a = 0; a < n; ++a) q_[c++ * rows_ + i] = weight_[i] * x[a];
    if (quadratic)
      for (size_t a = 0; a < n; ++a)
        for (size_t b = a; b < n; ++b) q_[c++ * rows_ + i] = weight_[i] * x[a] * x[b] * (a == b ? 0.5 : 1.0);
  }
  for (size_t c = 0; c < columns_; ++c) pivot_[c] = c;
  rank_ = 0;
  double first = 0;
  for (size_t c = 0; c < std::min(columns_, rows_); ++c) {
    size_t best = c;
    double best_norm = -1;
    for (size_t k = c; k < columns_; ++k) {
      double norm = 0;
      for (size_t i = c; i < rows_; ++i) norm += q_[k * rows_ + i] * q_[k * rows_ + i];
      if (norm > best_norm) best_norm = norm, best = k;
    }
    if (best != c) {
      std::swap_ranges(q_.begin() + ptrdiff_t(c * rows_), q_.begin() + ptrdiff_t((c + 1) * rows_), q_.begin() + ptrdiff_t(best * rows_));
      std::swap(pivot_[c], pivot_[best]);
    }
    const double norm = std::sqrt(best_norm);
    if (c == 0) first = norm;
    if (!(norm > smallest_pivot * first)) break;
    double* v = q_.data() + c * rows_;
    const double alpha = v[c] > 0 ? -norm : norm;
    r_[c] = alpha;
    v[c] -= alpha;
    double square = 0;
    for (size_t i = c; i < rows_; ++i) square += v[i] * v[i];
    for (size_t k = c + 1; k < columns_; ++k) {
      double* w = q_.data() + k * rows_;
      double s = 0;
      for (size_t i = c; i < rows_; ++i) s += v[i] * w[i];
      s *= 2 / square;
      for (size_t i = c; i < rows_; ++i) w[i] -= s * v[i];
    }
    ++rank_;
  }
  return rank_ == columns_;
}

void QuadraticFit::solve(std::span<const double> differences, Vec3& gradient, double hessian[6]) const {
  right_.resize(rows_);
  for (size_t i = 0; i < rows_; ++i) right_[i] = weight_[i] * differences[i];
  for (size_t c = 0; c < rank_; ++c) {  // Q^T b
    const double* v = q_.data() + c * rows_;
    double s = 0, square = 0;
    for (size_t i = c; i < rows_; ++i) s += v[i] * right_[i], square += v[i] * v[i];
    s *= 2 / square;
    for (size_t i = c; i < rows_; ++i) right_[i] -= s * v[i];
  }
  double x[9] = {};  // undetermined directions stay 0
  double y[9] = {};
  for (size_t c = rank_; c-- > 0;) {
    double s = right_[c];
    for (size_t k = c + 1; k < rank_; ++k) s -= q_[k * rows_ + c] * y[k];
    y[c] = s / r_[c];
    x[pivot_[c]] = y[c];
  }
  const auto n = size_t(dimension_);
  gradient = {0, 0, 0};
  for (size_t a = 0; a < n; ++a) gradient = gradient + axis_[a] * (x[a] / scale_);
  for (int i = 0; i < 6; ++i) hessian[i] = quadratic_ ? 0 : std::nan("");
  if (!quadratic_) return;
  size_t c = n;
  for (size_t a = 0; a < n; ++a)
    for (size_t b = a; b < n; ++b, ++c) {
      const double h = x[c] / (scale_ * scale_);
      for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
          hessian[hessian_place[i][j]] += h * (a == b ? axis_[a][i] * axis_[a][j] : axis_[a][i] * axis_[b][j] + axis_[b][i] * axis_[a][j]);
    }
}

}  // namespace sg
