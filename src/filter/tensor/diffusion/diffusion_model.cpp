// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/diffusion/diffusion_model.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "base/error.h"

namespace sg {

namespace {

constexpr int unknowns = 7;  // ln S0, Dxx Dyy Dzz Dxy Dyz Dxz

// Householder QR of an n x 7 matrix, rows first, in place; the same reflections on `right` (n numbers). False when the columns are
// dependent.
bool qr_solve(double* a, size_t n, double* right, double* x) {
  double diagonal[unknowns], largest = 0;
  for (int c = 0; c < unknowns; ++c) {
    double norm = 0;
    for (size_t r = size_t(c); r < n; ++r) norm += a[r * unknowns + size_t(c)] * a[r * unknowns + size_t(c)];
    norm = std::sqrt(norm);
    largest = std::max(largest, norm);
    if (!(norm > 1e-7 * largest)) return false;
    double& head = a[size_t(c) * unknowns + size_t(c)];
    diagonal[c] = head > 0 ? -norm : norm;
    head -= diagonal[c];
    const double half = -diagonal[c] * head;  // v^T v / 2
    auto reflect = [&](double* to, size_t stride) {
      double s = 0;
      for (size_t r = size_t(c); r < n; ++r) s += a[r * unknowns + size_t(c)] * to[r * stride];
      s /= half;
      for (size_t r = size_t(c); r < n; ++r) to[r * stride] -= s * a[r * unknowns + size_t(c)];
    };
    for (int k = c + 1; k < unknowns; ++k) reflect(a + k, unknowns);
    reflect(right, 1);
  }
  for (int c = unknowns; c-- > 0;) {
    double s = right[c];
    for (int k = c + 1; k < unknowns; ++k) s -= a[c * unknowns + k] * x[k];
    x[c] = s / diagonal[c];
  }
  return true;
}

// Symmetric positive 7 x 7 system by Cholesky; false when it is not positive.
bool solve_normal(double m[unknowns][unknowns], double* x) {
  for (int j = 0; j < unknowns; ++j)
    for (int i = j; i < unknowns; ++i) {
      double s = m[i][j];
      for (int k = 0; k < j; ++k) s -= m[i][k] * m[j][k];
      if (i == j) {
        if (!(s > 0)) return false;
        m[i][i] = std::sqrt(s);
      } else {
        m[i][j] = s / m[j][j];
      }
    }
  for (int i = 0; i < unknowns; ++i) {
    for (int k = 0; k < i; ++k) x[i] -= m[i][k] * x[k];
    x[i] /= m[i][i];
  }
  for (int i = unknowns; i-- > 0;) {
    for (int k = i + 1; k < unknowns; ++k) x[i] -= m[k][i] * x[k];
    x[i] /= m[i][i];
  }
  return true;
}

// L = l1 . . / l4 l2 . / l6 l5 l3, and D = L L^T in the order of the unknowns.
void tensor_of_root(const double* l, double* x) {
  x[0] = l[0];
  x[1] = l[1] * l[1];
  x[2] = l[4] * l[4] + l[2] * l[2];
  x[3] = l[6] * l[6] + l[5] * l[5] + l[3] * l[3];
  x[4] = l[1] * l[4];
  x[5] = l[4] * l[6] + l[2] * l[5];
  x[6] = l[1] * l[6];
}

SymTensor tensor_in(const double* x) { return {x[1], x[2], x[3], x[4], x[5], x[6]}; }

}  // namespace

DiffusionModel::DiffusionModel(const GradientTable& t) : n_(t.size()) {
  scale_ = 0;
  for (double b : t.b) scale_ = std::max(scale_, b);
  if (!(scale_ > 0)) fail_usage("all b-values are 0: the data carries no diffusion weighting", "tensor_fit");
  for (size_t i = 0; i < n_; ++i) {
    const double b = t.b[i] / scale_;
    const Vec3 g = t.g[i];
    rows_.insert(rows_.end(),
                 {1, -b * g.x * g.x, -b * g.y * g.y, -b * g.z * g.z, -2 * b * g.x * g.y, -2 * b * g.y * g.z, -2 * b * g.x * g.z});
  }
  log_.resize(n_), weight_.assign(n_, 1), right_.resize(n_), inverse_.resize(unknowns * n_);
  // Column by column: what a logarithm of 1 in one volume does to the unknowns.
  bool good = n_ >= unknowns;
  for (size_t i = 0; i < n_ && good; ++i) {
    double x[unknowns];
    work_ = rows_;
    std::fill(right_.begin(), right_.end(), 0.0);
    right_[i] = 1;
    good = qr_solve(work_.data(), n_, right_.data(), x);
    for (int k = 0; k < unknowns && good; ++k) inverse_[size_t(k) * n_ + i] = x[k];
  }
  if (!good)
    fail_usage(fmt::format("the {} gradients do not determine a tensor", n_), "tensor_fit",
               "use at least six directions not on one cone or plane, and a volume with another b-value (0)");
}

bool DiffusionModel::solve(const double* weight, double* x) {
  work_ = rows_;
  for (size_t i = 0; i < n_; ++i) {
    const double w = std::sqrt(weight[i]);
    for (size_t k = 0; k < unknowns; ++k) work_[i * unknowns + k] *= w;
    right_[i] = w * log_[i];
  }
  return qr_solve(work_.data(), n_, right_.data(), x);
}

double DiffusionModel::cost(const double* l) const {
  double x[unknowns], sum = 0;
  tensor_of_root(l, x);
  for (size_t i = 0; i < n_; ++i) {
    double e = log_[i];
    for (size_t k = 0; k < unknowns; ++k) e -= rows_[i * unknowns + k] * x[k];
    sum += weight_[i] * e * e;
  }
  return sum;
}

// Levenberg-Marquardt on the entries of L, from the tensor with its eigenvalues raised.
void DiffusionModel::fit_positive(double* x) {
  Eigen3 e = eigen_of(tensor_in(x));
  const double floor = 1e-3 * std::max(e.value[0], 1e-3);
  for (double& v : e.value) v = std::max(v, floor);
  const SymTensor d = compose(e);
  double l[unknowns];
  l[0] = x[0];
  l[1] = std::sqrt(d.xx), l[4] = d.xy / l[1], l[6] = d.xz / l[1];
  l[2] = std::sqrt(std::max(d.yy - l[4] * l[4], 1e-12)), l[5] = (d.yz - l[4] * l[6]) / l[2];
  l[3] = std::sqrt(std::max(d.zz - l[6] * l[6] - l[5] * l[5], 1e-12));
  double damping = 1e-3, best = cost(l);
  for (int round = 0; round < 60; ++round) {
    double normal[unknowns][unknowns] = {}, gradient[unknowns] = {}, now[unknowns];
    tensor_of_root(l, now);
    for (size_t i = 0; i < n_; ++i) {
      const double* r = &rows_[i * unknowns];
      double error = log_[i];
      for (size_t k = 0; k < unknowns; ++k) error -= r[k] * now[k];
      // Derivatives of row . x(L) by the entries of L.
      const double j[unknowns] = {r[0],
                                  2 * r[1] * l[1] + r[4] * l[4] + r[6] * l[6],
                                  2 * r[2] * l[2] + r[5] * l[5],
                                  2 * r[3] * l[3],
                                  2 * r[2] * l[4] + r[4] * l[1] + r[5] * l[6],
                                  2 * r[3] * l[5] + r[5] * l[2],
                                  2 * r[3] * l[6] + r[5] * l[4] + r[6] * l[1]};
      for (int a = 0; a < unknowns; ++a) {
        gradient[a] += weight_[i] * j[a] * error;
        for (int b = 0; b <= a; ++b) normal[a][b] += weight_[i] * j[a] * j[b];
      }
    }
    double most = 0;
    for (int a = 0; a < unknowns; ++a) most = std::max(most, normal[a][a]);
    bool better = false;
    for (int attempt = 0; attempt < 12 && !better; ++attempt) {
      double m[unknowns][unknowns], step[unknowns], next[unknowns];
      std::memcpy(m, normal, sizeof m);
      std::memcpy(step, gradient, sizeof step);
      for (int a = 0; a < unknowns; ++a) m[a][a] += damping * (normal[a][a] + 1e-9 * most);
      if (solve_normal(m, step)) {
        for (int a = 0; a < unknowns; ++a) next[a] = l[a] + step[a];
        const double c = cost(next);
        if (c < best) {
          better = best - c > 1e-14 * best;
          best = c, std::memcpy(l, next, sizeof l);
          damping = std::max(damping / 5, 1e-12);
          break;
        }
      }
      damping *= 5;
    }
    if (!better) break;
  }
  tensor_of_root(l, x);
}

DiffusionResult DiffusionModel::fit(std::span<const double> signal, DiffusionFit method) {
  DiffusionResult out;
  size_t useful = 0;
  for (size_t i = 0; i < n_; ++i) {
    const bool good = signal[i] > 0 && std::isfinite(signal[i]);
    if (std::isnan(signal[i])) return out;
    log_[i] = good ? std::log(signal[i]) : 0;
    weight_[i] = good;
    useful += good;
  }
  if (useful < unknowns) return out;
  double x[unknowns] = {};
  if (useful == n_) {
    for (size_t k = 0; k < unknowns; ++k)
      for (size_t i = 0; i < n_; ++i) x[k] += inverse_[k * n_ + i] * log_[i];
  } else if (!solve(weight_.data(), x)) {
    return out;
  }
  auto predicted = [&](size_t i) {
    double e = 0;
    for (size_t k = 0; k < unknowns; ++k) e += rows_[i * unknowns + k] * x[k];
    return std::exp(e);
  };
  if (method != DiffusionFit::linear)
    for (int round = 0; round < 2; ++round) {
      double largest = 0;
      for (size_t i = 0; i < n_; ++i)
        if (weight_[i] > 0) weight_[i] = predicted(i), weight_[i] *= weight_[i], largest = std::max(largest, weight_[i]);
      // Far below the strongest signal an exact zero would make the system singular.
      for (size_t i = 0; i < n_; ++i)
        if (weight_[i] > 0) weight_[i] = std::max(weight_[i] / largest, 1e-8);
      if (!solve(weight_.data(), x)) return out;
    }
  if (method == DiffusionFit::positive && !(eigen_of(tensor_in(x)).value[2] > 0)) out.raised = true, fit_positive(x);
  out.d = tensor_in(x) * (1 / scale_);
  out.s0 = std::exp(x[0]);
  double sum = 0;
  for (size_t i = 0; i < n_; ++i) {
    const double e = signal[i] - predicted(i);
    sum += e * e;
  }
  out.residual = std::sqrt(sum / double(n_));
  return out;
}

}  // namespace sg
