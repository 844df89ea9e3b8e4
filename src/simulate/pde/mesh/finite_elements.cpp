// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/mesh/finite_elements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/parallel.h"

namespace sg::pde {

namespace {

constexpr size_t points_at_once = 4096;

template <class F>
double fem_sum(size_t n, const Context& context, F&& f) {
  return parallel_reduce(
      n, points_at_once, 0.0,
      [&](size_t begin, size_t end) {
        double s = 0;
        for (size_t i = begin; i < end; ++i) s += f(i);
        return s;
      },
      [](double a, double b) { return a + b; }, &context);
}

template <class F>
void each_point(size_t n, const Context& context, F&& f) {
  parallel_for(
      n, points_at_once,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) f(i);
      },
      &context);
}

}  // namespace

Stiffness stiffness_of(const Simplices& s, const std::vector<double>& kappa, const Context& context) {
  const size_t n = s.at.size();
  const auto nodes = size_t(s.dimension) + 1;
  // Simplices of each point.
  std::vector<size_t> first(n + 1);
  for (const auto& c : s.corners)
    for (size_t v = 0; v < nodes; ++v) ++first[c[v] + 1];
  for (size_t i = 0; i < n; ++i) first[i + 1] += first[i];
  std::vector<uint32_t> around(first[n]);
  std::vector<size_t> fill(first.begin(), first.end() - 1);
  for (size_t t = 0; t < s.size(); ++t)
    for (size_t v = 0; v < nodes; ++v) around[fill[s.corners[t][v]]++] = uint32_t(t);
  Stiffness k;
  k.diagonal.resize(n), k.mass.resize(n), k.begin.resize(n + 1);
  // Rows by chunks, which are then put one behind the other.
  struct Rows {
    std::vector<uint32_t> column;
    std::vector<double> value;
  };
  std::vector<Rows> chunks(n / points_at_once + 1);
  parallel_for(
      n, points_at_once,
      [&](size_t begin, size_t end) {
        Rows& rows = chunks[begin / points_at_once];
        std::vector<std::pair<uint32_t, double>> row;
        std::array<Vec3, 4> g;
        for (size_t i = begin; i < end; ++i) {
          row.assign(1, {uint32_t(i), 0.0});
          for (size_t a = first[i]; a < first[i + 1]; ++a) {
            const size_t t = around[a];
            const double size = simplex_gradients(s, t, g);
            k.mass[i] += size / double(nodes);
            size_t own = 0;
            while (s.corners[t][own] != i) ++own;
            for (size_t v = 0; v < nodes; ++v) {
              const uint32_t column = s.corners[t][v];
              const auto found = std::find_if(row.begin(), row.end(), [&](const auto& e) { return e.first == column; });
              const double value = kappa[t] * size * dot(g[own], g[v]);
              if (found == row.end()) row.emplace_back(column, value);
              else found->second += value;
            }
          }
          k.diagonal[i] = row[0].second, k.begin[i + 1] = row.size();
          std::sort(row.begin(), row.end());
          for (const auto& [column, value] : row) rows.column.push_back(column), rows.value.push_back(value);
        }
      },
      &context);
  for (size_t i = 0; i < n; ++i) k.begin[i + 1] += k.begin[i];
  k.column.reserve(k.begin[n]), k.value.reserve(k.begin[n]);
  for (Rows& rows : chunks) {
    k.column.insert(k.column.end(), rows.column.begin(), rows.column.end());
    k.value.insert(k.value.end(), rows.value.begin(), rows.value.end());
    rows = {};
  }
  return k;
}

void apply(const Stiffness& k, double shift, double scale, const std::vector<double>& x, std::vector<double>& out, const Context& context) {
  each_point(k.points(), context, [&](size_t i) {
    double sum = 0;
    for (size_t e = k.begin[i]; e < k.begin[i + 1]; ++e) sum += k.value[e] * x[k.column[e]];
    out[i] = shift * k.mass[i] * x[i] + scale * sum;
  });
}

FemSolve solve(const Stiffness& k, double shift, double scale, const std::vector<double>& b, const std::vector<uint8_t>& held,
               double tolerance, int most, std::vector<double>& x, const Context& context) {
  const size_t n = k.points();
  std::vector<double> r(n), z(n), s(n), weight(n);
  each_point(n, context, [&](size_t i) {
    const double d = shift * k.mass[i] + scale * k.diagonal[i];
    weight[i] = held[i] || !(d > 0) ? 0 : 1 / d;
  });
  // The size of the right side, with what the held values give.
  each_point(n, context, [&](size_t i) { s[i] = weight[i] > 0 ? 0 : x[i]; });
  apply(k, shift, scale, s, z, context);
  const double size = fem_sum(n, context, [&](size_t i) { return weight[i] * (b[i] - z[i]) * (b[i] - z[i]); });
  FemSolve result;
  if (size == 0) {
    each_point(n, context, [&](size_t i) { x[i] = weight[i] > 0 ? 0 : x[i]; });
    result.reached = true;
    return result;
  }
  apply(k, shift, scale, x, z, context);
  each_point(n, context, [&](size_t i) { r[i] = weight[i] > 0 ? b[i] - z[i] : 0, s[i] = 0; });
  double before = 0;
  for (;; ++result.iterations) {
    const double now = fem_sum(n, context, [&](size_t i) { return weight[i] * r[i] * r[i]; });
    result.residual = std::sqrt(now / size);
    result.reached = result.residual <= tolerance;
    if (result.reached || result.iterations == most || !std::isfinite(now)) return result;
    const double beta = result.iterations == 0 ? 0 : now / before;
    before = now;
    each_point(n, context, [&](size_t i) { s[i] = weight[i] * r[i] + beta * s[i]; });
    apply(k, shift, scale, s, z, context);
    const double curvature = fem_sum(n, context, [&](size_t i) { return s[i] * z[i]; });
    if (!(curvature > 0)) return result;  // nothing is left but rounding
    const double alpha = now / curvature;
    each_point(n, context, [&](size_t i) { x[i] += alpha * s[i], r[i] -= weight[i] > 0 ? alpha * z[i] : 0; });
  }
}

}  // namespace sg::pde
