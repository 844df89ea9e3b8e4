// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/tissue_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"

namespace sg {

namespace {

constexpr size_t voxels_per_chunk = 2048;
constexpr int max_parts = 64;

double normal_density(double z) { return std::exp(-0.5 * z * z) * 0.3989422804014327; }
double normal_below(double z) { return 0.5 * std::erfc(-z * M_SQRT1_2); }

}  // namespace

void legendre(double x, int degree, double* p) {
  p[0] = 1;
  if (degree > 0) p[1] = x;
  for (int n = 1; n < degree; ++n) p[n + 1] = ((2 * n + 1) * x * p[n] - n * p[n - 1]) / (n + 1);
}

BiasPolynomial::BiasPolynomial(int d, const std::array<bool, 3>& axes) : degree(d) {
  for (int total = 1; total <= d; ++total)
    for (int k = 0; k <= total; ++k)
      for (int j = 0; j <= total - k; ++j) {
        const int i = total - j - k;
        if ((i == 0 || axes[0]) && (j == 0 || axes[1]) && (k == 0 || axes[2])) terms.push_back({i, j, k});
      }
  coefficient.assign(terms.size(), 0);
}

size_t BiasPolynomial::terms_up_to(int d) const {
  size_t n = 0;
  while (n < terms.size() && terms[n][0] + terms[n][1] + terms[n][2] <= d) ++n;
  return n;
}

void BiasPolynomial::basis(Vec3 at, double* values) const {
  double p[3][16];
  for (int a = 0; a < 3; ++a) legendre(at[a], degree, p[a]);
  for (size_t t = 0; t < terms.size(); ++t) values[t] = p[0][terms[t][0]] * p[1][terms[t][1]] * p[2][terms[t][2]];
}

double BiasPolynomial::log_value(const double* values) const {
  double s = log_scale;
  for (size_t t = 0; t < terms.size(); ++t) s += coefficient[t] * values[t];
  return std::clamp(s, -2.0, 2.0);  // where no tissue is, a polynomial may run away
}

void part_densities(const TissueModel& m, double y, double factor, double* density, double* proportion) {
  const size_t k = m.pure();
  const auto mean = [&](size_t c) { return c == 0 && m.background ? m.mean[0] : factor * m.mean[c]; };
  for (size_t c = 0; c < k; ++c) density[c] = normal_density((y - mean(c)) / m.deviation[c]) / m.deviation[c];
  for (size_t c = k; c < m.parts(); ++c) {
    const double lo = mean(c - k), hi = std::max(mean(c - k + 1), lo + 1e-3 * m.deviation[c - k]),
                 sigma = (m.deviation[c - k] + m.deviation[c - k + 1]) / 2;
    // Proportions are uniform: a normal distribution smeared from lo to hi, and the mean of one cut off at both ends.
    const double from = (y - hi) / sigma, to = (y - lo) / sigma;
    const double mass = normal_below(to) - normal_below(from);
    density[c] = mass / (hi - lo);
    const double shift = normal_density(to) - normal_density(from);
    proportion[c - k] = mass > 1e-12 ? std::clamp((y - lo + sigma * shift / mass) / (hi - lo), 0.0, 1.0)
                        : y < lo     ? 0.0
                        : y > hi     ? 1.0
                                     : 0.5;
  }
}

namespace {

// What the maximisation needs, summed over samples.
struct Sums {
  std::vector<double> share, y, square, yy;  // per part: p; per class: p b y, p b^2, p (y - b mean)^2
  std::vector<double> matrix, right;         // normal equations of the bias
  double log_likelihood = 0;
  void add(const Sums& o) {
    const auto sum = [](std::vector<double>& a, const std::vector<double>& b) {
      if (a.empty()) a = b;
      else
        for (size_t i = 0; i < a.size(); ++i) a[i] += b[i];
    };
    sum(share, o.share), sum(y, o.y), sum(square, o.square), sum(yy, o.yy), sum(matrix, o.matrix), sum(right, o.right);
    log_likelihood += o.log_likelihood;
  }
};

Sums expectation(const TissueModel& m, const TissueSamples& s, size_t active, size_t begin, size_t end) {
  const size_t k = m.pure(), parts = m.parts(), terms = m.bias.terms.size();
  Sums r;
  r.share.assign(parts, 0), r.y.assign(k, 0), r.square.assign(k, 0), r.yy.assign(k, 0);
  r.matrix.assign(active * active, 0), r.right.assign(active, 0);
  double density[max_parts], proportion[max_parts];
  for (size_t i = begin; i < end; ++i) {
    const double* phi = s.basis.data() + i * terms;
    const double y = s.value[i], b = std::exp(m.bias.log_value(phi));
    part_densities(m, y, b, density, proportion);
    double total = 1e-300;
    for (size_t c = 0; c < parts; ++c) total += density[c] *= m.share[c];
    r.log_likelihood += std::log(total);
    double weight = 0, pull = 0;
    for (size_t c = 0; c < parts; ++c) {
      const double p = density[c] / total;
      r.share[c] += p;
      if (c >= k) continue;
      const bool nothing = c == 0 && m.background;
      const double f = nothing ? 1.0 : b, model = f * m.mean[c], rest = y - model, precision = p / (m.deviation[c] * m.deviation[c]);
      r.y[c] += p * f * y, r.square[c] += p * f * f, r.yy[c] += p * rest * rest;
      if (nothing) continue;
      weight += precision * model * model, pull += precision * model * rest;
    }
    for (size_t a = 0; a < active; ++a) {
      const double wa = weight * phi[a];
      for (size_t c = 0; c <= a; ++c) r.matrix[a * active + c] += wa * phi[c];
      r.right[a] += pull * phi[a];
    }
  }
  return r;
}

// Cholesky; the lower triangle of `a` is destroyed. False for a matrix that is not positive.
bool solve(std::vector<double>& a, std::vector<double>& x) {
  const size_t n = x.size();
  for (size_t j = 0; j < n; ++j) {
    for (size_t k = 0; k < j; ++k) a[j * n + j] -= a[j * n + k] * a[j * n + k];
    if (!(a[j * n + j] > 0)) return false;
    const double d = a[j * n + j] = std::sqrt(a[j * n + j]);
    for (size_t i = j + 1; i < n; ++i) {
      for (size_t k = 0; k < j; ++k) a[i * n + j] -= a[i * n + k] * a[j * n + k];
      a[i * n + j] /= d;
    }
  }
  for (size_t i = 0; i < n; ++i) {
    for (size_t k = 0; k < i; ++k) x[i] -= a[i * n + k] * x[k];
    x[i] /= a[i * n + i];
  }
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; ++k) x[i] -= a[k * n + i] * x[k];
    x[i] /= a[i * n + i];
  }
  return true;
}

void maximisation(TissueModel& m, Sums& s, double samples, size_t active, const FitOptions& options) {
  const size_t k = m.pure();
  // Bias first, by one Gauss-Newton step; what the data do not determine (no tissue there) stays near zero.
  double trace = 0;
  for (size_t t = 0; t < active; ++t) trace += s.matrix[t * active + t];
  if (active > 0 && trace > 0) {
    for (size_t t = 0; t < active; ++t) {
      const auto& e = m.bias.terms[t];
      const double stiff = 1e-5 * trace * std::pow(double(e[0] + e[1] + e[2]), 4);
      s.matrix[t * active + t] += stiff;
      s.right[t] -= stiff * m.bias.coefficient[t];
    }
    if (solve(s.matrix, s.right))
      for (size_t t = 0; t < active; ++t) m.bias.coefficient[t] += s.right[t];
  }
  for (size_t c = 0; c < k; ++c) {
    if (s.share[c] < 1e-6 * samples || s.square[c] <= 0) continue;  // an empty class keeps its place
    m.mean[c] = s.y[c] / s.square[c];
    m.deviation[c] = std::max(options.least_deviation, std::sqrt(s.yy[c] / s.share[c]));
  }
  for (size_t c = 0; c < m.parts(); ++c) m.share[c] = std::max(1e-6, s.share[c] / samples);
  // Mixtures need classes that are ordered and separated.
  std::vector<size_t> order(k);
  std::iota(order.begin(), order.end(), size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return m.mean[a] < m.mean[b]; });
  const TissueModel old = m;
  for (size_t c = 0; c < k; ++c) m.mean[c] = old.mean[order[c]], m.deviation[c] = old.deviation[order[c]], m.share[c] = old.share[order[c]];
  for (size_t c = 1; c < k; ++c) m.mean[c] = std::max(m.mean[c], m.mean[c - 1] + options.least_deviation);
}

}  // namespace

void fit_tissues(TissueModel& m, const TissueSamples& s, const FitOptions& options, const Context& context) {
  const size_t n = s.value.size();
  constexpr int rounds_per_degree = 4;
  const int top = options.with_bias ? m.bias.degree : 0;
  double before = -HUGE_VAL;
  m.converged = false;
  for (int round = 0; round < options.iterations; ++round) {
    const int degree = std::min(top, round / rounds_per_degree);
    const size_t active = m.bias.terms_up_to(degree);
    Sums sums = parallel_reduce(
        n, voxels_per_chunk, Sums{}, [&](size_t begin, size_t end) { return expectation(m, s, active, begin, end); },
        [](Sums a, const Sums& b) {
          a.add(b);
          return a;
        },
        &context);
    m.log_likelihood = sums.log_likelihood / double(n);
    ++m.iterations;
    context.progress(double(round) / options.iterations, "fitting classes");
    if (degree == top && round > rounds_per_degree * (top + 1) && m.log_likelihood - before < options.tolerance) {
      m.converged = true;
      break;
    }
    before = m.log_likelihood;
    maximisation(m, sums, double(n), active, options);
  }
}

}  // namespace sg
