// SPDX-License-Identifier: Apache-2.0
#include "filter/field/derivatives/quadratic_fit.h"

#include <algorithm>
#include <cmath>

namespace sg {

namespace {

// Places of xx, xy, xz, yy, yz, zz.
constexpr int hessian_place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
constexpr double flat = 1e-7;              // extents that count as none, of the largest
constexpr double smallest_slope = 1e-4;    // sine below which a first derivative is not determined
constexpr double smallest_bend = 1e-12;    // below it there is nothing to take
constexpr double smallest_product = 0.03;  // length below which a combination of second derivatives is not determined
constexpr double smallest_cubic = 0.05;    // sine below which a third derivative is not determined
constexpr double even_height = 1e-12;      // of the mean distance: a flat surface

// In four sums, the same four on every machine: additions that wait for one another would take most of the time of a fit.
double dot_of(const double* a, const double* b, size_t n) {
  double s[4] = {0, 0, 0, 0};
  size_t i = 0;
  for (; i + 4 <= n; i += 4)
    for (size_t k = 0; k < 4; ++k) s[k] += a[i + k] * b[i + k];
  for (; i < n; ++i) s[i % 4] += a[i] * b[i];
  return (s[0] + s[2]) + (s[1] + s[3]);
}

// Rotates columns in pairs until they are orthogonal (one-sided Jacobi, Hestenes 1958): column k of `a` is at a + k * stride; `v`, n x n,
// receives the rotation: new a = old a * v.
void rotate_apart(double* a, size_t stride, size_t rows, size_t n, double* v, size_t v_stride) {
  for (size_t i = 0; i < n; ++i)
    for (size_t k = 0; k < n; ++k) v[i * v_stride + k] = i == k;
  for (int sweep = 0; sweep < 30; ++sweep) {
    bool turned = false;
    for (size_t p = 0; p + 1 < n; ++p)
      for (size_t q = p + 1; q < n; ++q) {
        double *x = a + p * stride, *y = a + q * stride, xx = 0, yy = 0, xy = 0;
        for (size_t i = 0; i < rows; ++i) xx += x[i] * x[i], yy += y[i] * y[i], xy += x[i] * y[i];
        if (!(std::fabs(xy) > 1e-15 * std::sqrt(xx * yy))) continue;
        turned = true;
        const double theta = (yy - xx) / (2 * xy);
        const double t = (theta >= 0 ? 1 : -1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (size_t i = 0; i < rows; ++i) {
          const double u = x[i], w = y[i];
          x[i] = c * u - s * w, y[i] = s * u + c * w;
        }
        for (size_t i = 0; i < n; ++i) {
          double &u = v[i * v_stride + p], &w = v[i * v_stride + q];
          const double old = u;
          u = c * old - s * w, w = s * old + c * w;
        }
      }
    if (!turned) break;
  }
}

}  // namespace

void QuadraticFit::place(std::span<const Vec3> offsets, int dimension, Vec3 normal, bool cubic) {
  dimension_ = dimension, rows_ = offsets.size(), columns_ = cubic ? needed_by_cubic(dimension) : needed(dimension);
  weight_.resize(rows_);
  double sum = 0;
  for (size_t i = 0; i < rows_; ++i) sum += weight_[i] = length(offsets[i]);
  scale_ = rows_ == 0 || sum == 0 ? 1 : sum / double(rows_);
  for (size_t i = 0; i < rows_; ++i) weight_[i] = scale_ / weight_[i];
  choose_axes(offsets, normal);
  factorise(offsets);
  if (determined_ < well_determined && dimension > 1) {
    use_principal_axes(offsets, dimension);
    factorise(offsets);
  }
  split_ = bent_ = false;
  undetermined_ = 0;
  if (dimension < 3) fit_heights(offsets);
}

void QuadraticFit::choose_axes(std::span<const Vec3> offsets, Vec3 normal) {
  axis_[0] = {1, 0, 0}, axis_[1] = {0, 1, 0}, axis_[2] = {0, 0, 1};
  for (double& u : unit_) u = 1 / scale_;
  if (dimension_ == 3) return;
  Vec3 n = normalize(normal);
  if (dimension_ == 1 || dot(n, n) == 0) {
    use_principal_axes(offsets, 3);
    for (double& u : unit_) u = 1 / scale_;
    if (dimension_ == 1) return;
    n = axis_[2];
  }
  const Vec3 other = std::fabs(n.x) <= std::fabs(n.y) && std::fabs(n.x) <= std::fabs(n.z) ? Vec3{1, 0, 0}
                     : std::fabs(n.y) <= std::fabs(n.z)                                   ? Vec3{0, 1, 0}
                                                                                          : Vec3{0, 0, 1};
  axis_[0] = normalize(cross(n, other));
  axis_[1] = cross(n, axis_[0]);
  axis_[2] = n;
}

// Turns the first `dimension` axes to the principal ones of the place and its neighbours, longest first. About their mean: at borders
// those about the place itself would slant inwards.
void QuadraticFit::use_principal_axes(std::span<const Vec3> offsets, int dimension) {
  const auto n = size_t(dimension);
  Vec3 mean;
  for (const Vec3& d : offsets) mean += d;
  mean = mean / double(rows_ + 1);
  q_.resize(rows_ * n + n);
  for (size_t i = 0; i <= rows_; ++i)
    for (size_t a = 0; a < n; ++a) q_[a * (rows_ + 1) + i] = dot((i < rows_ ? offsets[i] : Vec3()) - mean, axis_[a]) / scale_;
  double v[9], extent[3];
  rotate_apart(q_.data(), rows_ + 1, rows_ + 1, n, v, n);
  for (size_t a = 0; a < n; ++a) {
    double square = 0;
    for (size_t i = 0; i <= rows_; ++i) square += q_[a * (rows_ + 1) + i] * q_[a * (rows_ + 1) + i];
    extent[a] = std::sqrt(square / double(rows_ + 1));
  }
  size_t by_extent[3] = {0, 1, 2};
  std::sort(by_extent, by_extent + n, [&](size_t a, size_t b) { return extent[a] != extent[b] ? extent[a] > extent[b] : a < b; });
  const Vec3 old[3] = {axis_[0], axis_[1], axis_[2]};
  for (size_t a = 0; a < n; ++a) {
    const size_t from = by_extent[a];
    axis_[a] = {0, 0, 0};
    for (size_t b = 0; b < n; ++b) axis_[a] += old[b] * v[b * n + from];
    unit_[a] = extent[from] > flat * extent[by_extent[0]] ? 1 / (scale_ * extent[from]) : 0;
  }
}

// Columns of coordinates and their products, rows weighted by 1/|d|, scaled to length 1.
void QuadraticFit::fill_columns(std::span<const Vec3> offsets) {
  const auto n = size_t(dimension_);
  q_.resize(rows_ * columns_);
  for (size_t i = 0; i < rows_; ++i) {
    double x[3];
    for (size_t a = 0; a < n; ++a) x[a] = dot(offsets[i], axis_[a]) * unit_[a];
    size_t c = 0;
    for (size_t a = 0; a < n; ++a) q_[c++ * rows_ + i] = weight_[i] * x[a];
    for (size_t a = 0; a < n; ++a)
      for (size_t b = a; b < n; ++b) q_[c++ * rows_ + i] = weight_[i] * x[a] * x[b] * (a == b ? 0.5 : 1.0);
    for (size_t a = 0; a < n && c < columns_; ++a)
      for (size_t b = a; b < n; ++b)
        for (size_t d = b; d < n; ++d) q_[c++ * rows_ + i] = weight_[i] * x[a] * x[b] * x[d];
  }
  for (size_t c = 0; c < columns_; ++c) {
    double* v = q_.data() + c * rows_;
    const double square = dot_of(v, v, rows_);
    norm_[c] = std::sqrt(square);
    left_[c] = square > 0 ? 1 : 0;
    const double shrink = square > 0 ? 1 / norm_[c] : 0;
    for (size_t i = 0; i < rows_; ++i) v[i] *= shrink;
  }
  const double longest = *std::max_element(norm_, norm_ + n);
  for (size_t c = 0; c < n; ++c)
    if (!(norm_[c] > flat * longest)) left_[c] = 0;
}

// QR with column pivoting among coordinates, then among products of two, then of three: what cannot be distinguished is left to the
// coordinates.
void QuadraticFit::factorise(std::span<const Vec3> offsets) {
  fill_columns(offsets);
  determined_ = 1, rank_ = 0;
  std::fill(taken_, taken_ + columns_, false);
  take_columns(0, size_t(dimension_), smallest_slope);
  slopes_ = rank_;
  take_columns(size_t(dimension_), needed(dimension_), smallest_bend);
  const double determined = determined_;
  if (determined >= well_determined) take_columns(needed(dimension_), columns_, smallest_cubic);
  determined_ = determined;
}

void QuadraticFit::take_columns(size_t begin, size_t end, double smallest) {
  for (size_t turn = begin; turn < end; ++turn) {
    size_t best = columns_;
    for (size_t k = begin; k < end; ++k)
      if (!taken_[k] && (best == columns_ || left_[k] > left_[best])) best = k;
    const size_t c = rank_;
    double* v = q_.data() + best * rows_;
    const double square = left_[best] > 0 ? dot_of(v + c, v + c, rows_ - c) : 0;
    const double norm = std::sqrt(square);
    determined_ = std::min(determined_, norm);
    if (!(norm > smallest)) return;
    const double alpha = v[c] > 0 ? -norm : norm;
    beta_[c] = 1 / (square - alpha * v[c]);
    r_[c] = alpha;
    v[c] -= alpha;
    taken_[best] = true, order_[rank_++] = best;
    for (size_t k = 0; k < columns_; ++k) {
      if (taken_[k]) continue;
      double* w = q_.data() + k * rows_;
      const double s = beta_[c] * dot_of(v + c, w + c, rows_ - c);
      for (size_t i = c; i < rows_; ++i) w[i] -= s * v[i];
      left_[k] -= w[c] * w[c];
    }
  }
}

// The rows of R that belong only to the products, as orthogonal columns: short ones are combinations that nothing determines.
void QuadraticFit::split_products() {
  const auto n = size_t(dimension_), products = needed(dimension_) - n, rows = rank_ - slopes_;
  split_ = true;
  for (size_t k = 0; k < products; ++k) {
    const double* column = q_.data() + (n + k) * rows_;
    for (size_t i = 0; i < most_products; ++i) products_[k][i] = i < rows ? column[slopes_ + i] : 0;
  }
  for (size_t c = slopes_; c < rank_; ++c) {
    double* column = products_[order_[c] - n];
    column[c - slopes_] = r_[c];
    std::fill(column + (c - slopes_) + 1, column + most_products, 0);
  }
  rotate_apart(products_[0], most_products, most_products, products, rotation_[0], most_products);
  undetermined_ = n - slopes_;
  for (size_t k = 0; k < products; ++k) {
    double square = 0;
    for (const double x : products_[k]) square += x * x;
    if (square > smallest_product * smallest_product) {
      for (double& x : products_[k]) x /= square;
    } else {
      std::fill_n(products_[k], most_products, 0), ++undetermined_;
    }
  }
}

// right_ (weighted, overwritten) to derivatives along the axes; those not determined are 0.
void QuadraticFit::fit(double* slope, double* bend) {
  split_when_poor();
  const auto n = size_t(dimension_), products = needed(dimension_) - n;
  for (size_t c = 0; c < rank_; ++c) {  // Q^T b
    const double* v = q_.data() + order_[c] * rows_;
    const double s = beta_[c] * dot_of(v + c, right_.data() + c, rows_ - c);
    for (size_t i = c; i < rows_; ++i) right_[i] -= s * v[i];
  }
  double x[most_columns] = {};
  size_t rest = rank_;
  if (split_) {
    for (size_t k = 0; k < products; ++k) {
      double along = 0;
      for (size_t c = slopes_; c < rank_; ++c) along += products_[k][c - slopes_] * right_[c];
      for (size_t p = 0; p < products; ++p) x[n + p] += rotation_[p][k] * along;
    }
    rest = slopes_;
  }
  for (size_t c = rest; c-- > 0;) {
    double s = right_[c];
    for (size_t k = 0; k < columns_; ++k)
      if (x[k] != 0) s -= q_[k * rows_ + c] * x[k];
    x[order_[c]] = s / r_[c];
  }
  size_t c = 0;
  const auto unscaled = [&](double unit) {
    const double y = norm_[c] > 0 ? x[c] / norm_[c] * unit : 0;
    ++c;
    return y;
  };
  for (size_t a = 0; a < n; ++a) slope[a] = unscaled(unit_[a]);
  for (size_t a = 0, k = 0; a < n; ++a)
    for (size_t b = a; b < n; ++b) bend[k++] = unscaled(unit_[a] * unit_[b]);
}

// Neighbours of a point of a bent line or surface lie off its tangent: how far is a field like others.
void QuadraticFit::fit_heights(std::span<const Vec3> offsets) {
  double highest = 0;
  for (int across = dimension_; across < 3; ++across)
    for (const Vec3& d : offsets) highest = std::max(highest, std::fabs(dot(d, axis_[across])));
  bent_ = highest > even_height * scale_;
  if (!bent_) return;
  right_.resize(rows_);
  for (int across = dimension_; across < 3; ++across) {
    for (size_t i = 0; i < rows_; ++i) right_[i] = weight_[i] * dot(offsets[i], axis_[across]);
    fit(height_slope_[across - dimension_], height_bend_[across - dimension_]);
  }
}

void QuadraticFit::solve(std::span<const double> differences, Vec3& gradient, double* hessian) {
  right_.resize(rows_);
  for (size_t i = 0; i < rows_; ++i) right_[i] = weight_[i] * differences[i];
  double slope[3], bend[6];
  fit(slope, bend);
  gradient = {0, 0, 0};
  if (hessian) std::fill_n(hessian, 6, 0.0);
  const auto n = size_t(dimension_);
  if (bent_) return follow_surface(slope, bend, gradient, hessian);
  for (size_t a = 0; a < n; ++a) gradient += axis_[a] * slope[a];
  if (!hessian) return;
  size_t c = 0;
  for (size_t a = 0; a < n; ++a)
    for (size_t b = a; b < n; ++b, ++c)
      for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
          hessian[hessian_place[i][j]] +=
              bend[c] * (a == b ? axis_[a][i] * axis_[a][j] : axis_[a][i] * axis_[b][j] + axis_[b][i] * axis_[a][j]);
}

// Derivatives along the surface X(u) = sum u_a axis_a + heights: with tangents t_a = dX/du_a and the metric g_ab = t_a.t_b the gradient
// is g^ab f_a t_b, the Hessian (f_ab - C^c_ab f_c) t^a t^b with t^a = g^ab t_b and Christoffel symbols C^c_ab = t^c.X_ab.
void QuadraticFit::follow_surface(const double* slope, const double* bend, Vec3& gradient, double* hessian) const {
  const int n = dimension_, across = 3 - n;
  Vec3 tangent[2], dual[2];
  for (int a = 0; a < n; ++a) {
    tangent[a] = axis_[a];
    for (int k = 0; k < across; ++k) tangent[a] += axis_[n + k] * height_slope_[k][a];
  }
  const double g00 = dot(tangent[0], tangent[0]);
  if (n == 1) {
    dual[0] = tangent[0] / g00;
  } else {
    const double g01 = dot(tangent[0], tangent[1]), g11 = dot(tangent[1], tangent[1]), d = g00 * g11 - g01 * g01;
    dual[0] = (tangent[0] * g11 - tangent[1] * g01) / d;
    dual[1] = (tangent[1] * g00 - tangent[0] * g01) / d;
  }
  for (int a = 0; a < n; ++a) gradient += dual[a] * slope[a];
  if (!hessian) return;
  int c = 0;
  for (int a = 0; a < n; ++a)
    for (int b = a; b < n; ++b, ++c) {
      double h = bend[c];
      for (int k = 0; k < across; ++k) h -= dot(gradient, axis_[n + k]) * height_bend_[k][c];
      for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
          hessian[hessian_place[i][j]] += h * (a == b ? dual[a][i] * dual[a][j] : dual[a][i] * dual[b][j] + dual[b][i] * dual[a][j]);
    }
}

}  // namespace sg
