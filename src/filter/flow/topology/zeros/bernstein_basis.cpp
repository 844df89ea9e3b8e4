// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/zeros/bernstein_basis.h"

#include <algorithm>

#include "base/random.h"

namespace sg {

namespace {

// Solves a square system by elimination with pivots; false when it is singular.
bool solve_dense(std::vector<double>& a, std::vector<double>& b, size_t n, size_t right) {
  for (size_t k = 0; k < n; ++k) {
    size_t pivot = k;
    for (size_t i = k + 1; i < n; ++i)
      if (std::abs(a[i * n + k]) > std::abs(a[pivot * n + k])) pivot = i;
    if (!(std::abs(a[pivot * n + k]) > 0)) return false;
    for (size_t j = 0; j < n; ++j) std::swap(a[k * n + j], a[pivot * n + j]);
    for (size_t j = 0; j < right; ++j) std::swap(b[k * right + j], b[pivot * right + j]);
    for (size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      const double f = a[i * n + k] / a[k * n + k];
      if (f == 0) continue;
      for (size_t j = k; j < n; ++j) a[i * n + j] -= f * a[k * n + j];
      for (size_t j = 0; j < right; ++j) b[i * right + j] -= f * b[k * right + j];
    }
  }
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < right; ++j) b[i * right + j] /= a[i * n + i];
  return true;
}

double binomial(int n, int k) {
  double r = 1;
  for (int i = 1; i <= k; ++i) r = r * (n - k + i) / i;
  return r;
}
double bernstein(int n, int k, double x) { return binomial(n, k) * std::pow(x, k) * std::pow(1 - x, n - k); }

ZeroDomain domain_of(const CellShape& s) {
  const CellType b = s.base();
  return b == CellType::triangle || b == CellType::tetra ? ZeroDomain::simplex : b == CellType::wedge ? ZeroDomain::prism : ZeroDomain::box;
}

}  // namespace

BernsteinBasis::BernsteinBasis(const CellShape& s) : shape_(&s), domain_(domain_of(s)), solver_(s.dimension(), 1) {
  const auto o = s.orders();
  const int lowest = std::max({o[0], o[1], o[2], 1});
  for (int degree = lowest; degree <= lowest + 3; ++degree) {
    fill(degree);
    if (misfit() < 1e-9) return;
  }
  fill(lowest);  // none is exact
}

Vec3 BernsteinBasis::reference(Vec3 u) const {
  if (!pyramid()) return u;
  return {0.5 + (u.x - 0.5) * (1 - u.z), 0.5 + (u.y - 0.5) * (1 - u.z), u.z};
}

void BernsteinBasis::set(std::span<const Vec3> v, std::span<const double> rational) {
  const size_t n = v.size();
  for (int c = 0; c < shape_->dimension(); ++c) {
    const auto to = solver_.coefficients(c);
    for (size_t i = 0; i < to.size(); ++i) {
      double sum = 0;
      for (size_t k = 0; k < n; ++k) sum += matrix_[i * n + k] * v[k][c] * (rational.empty() ? 1 : rational[k]);
      to[i] = sum;
    }
  }
}

void BernsteinBasis::take_out_apex() {
  // Division of sum b_k B_k^n by 1 - z gives b_k n / (n - k) of degree n - 1, here written in degree n again.
  const int n = solver_.degree();
  const auto layer = size_t(n + 1) * size_t(n + 1);
  for (int c = 0; c < 3; ++c) {
    const auto b = solver_.coefficients(c);
    for (size_t i = 0; i < layer; ++i) {
      b[i + size_t(n) * layer] = 0;
      for (int k = n; k > 0; --k) b[i + size_t(k) * layer] += b[i + size_t(k - 1) * layer] * k / (n - k + 1);
    }
  }
}

bool BernsteinBasis::solve(std::vector<Vec3>& zeros, std::span<const std::array<Vec3, 2>> known) {
  return solver_.solve(domain_, zeros, known);
}

void BernsteinBasis::fill(int n) {
  solver_ = BernsteinZeros(shape_->dimension(), n);
  const int d = shape_->dimension();
  const auto m = size_t(n + 1);
  const size_t size = solver_.size(), nodes = shape_->nodes();
  matrix_.assign(size * nodes, 0);
  // Samples; those of pyramids stay below the apex, where the shape functions are quotients of zeros.
  auto sample = [&](int i, int axis) { return double(i) / (pyramid() && axis == 2 ? n + 0.5 : n); };
  for (size_t p = 0; p < size; ++p) {
    const Vec3 u(sample(int(p % m), 0), sample(int(p / m % m), 1), d == 3 ? sample(int(p / m / m), 2) : 0);
    shape_->values(reference(u), &matrix_[p * nodes]);
  }
  for (int axis = 0; axis < d; ++axis) {
    std::vector<double> a(m * m), inverse(m * m, 0.0);
    for (size_t i = 0; i < m; ++i) {
      inverse[i * m + i] = 1;
      for (size_t j = 0; j < m; ++j) a[i * m + j] = bernstein(n, int(j), sample(int(i), axis));
    }
    solve_dense(a, inverse, m, m);
    const size_t step = axis == 0 ? 1 : axis == 1 ? m : m * m;
    std::vector<double> line(m);
    for (size_t first = 0; first < size; ++first) {
      if (first / step % m) continue;
      for (size_t k = 0; k < nodes; ++k) {
        for (size_t i = 0; i < m; ++i) line[i] = matrix_[(first + i * step) * nodes + k];
        for (size_t i = 0; i < m; ++i) {
          double sum = 0;
          for (size_t j = 0; j < m; ++j) sum += inverse[i * m + j] * line[j];
          matrix_[(first + i * step) * nodes + k] = sum;
        }
      }
    }
  }
}

// The largest difference between the polynomial and the shape functions at a few places.
double BernsteinBasis::misfit() {
  std::vector<double> n(shape_->nodes());
  double worst = 0;
  for (size_t k = 0; k < shape_->nodes(); ++k) {
    for (size_t i = 0; i < solver_.size(); ++i) solver_.coefficients(0)[i] = matrix_[i * shape_->nodes() + k];
    for (uint64_t i = 0; i < 4; ++i) {
      const Vec3 u(random_unit(1, 3 * i), random_unit(1, 3 * i + 1), shape_->dimension() == 3 ? 0.9 * random_unit(1, 3 * i + 2) : 0);
      shape_->values(reference(u), n.data());
      worst = std::max(worst, std::abs(solver_.value(u).x - n[k]));
    }
  }
  return worst;
}

}  // namespace sg
