// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/krylov.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace sg::swarm {

namespace {

using Vectors = std::vector<Vec3>;

double inner(const Vectors& a, const Vectors& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += dot(a[i], b[i]);
  return sum;
}

// GMRES (Saad, Schultz 1986) from 0, by modified Gram-Schmidt and Givens' turns, to `share` of |b|.
template <class Product>
Vectors gmres(Product&& product, const Vectors& b, double share) {
  constexpr size_t most = 60;
  const double size = std::sqrt(inner(b, b));
  Vectors x(b.size());
  if (size == 0) return x;
  std::vector<Vectors> basis{b};
  for (Vec3& u : basis[0]) u *= 1 / size;
  std::vector<std::vector<double>> h;
  std::vector<double> c, s, g{size};
  while (h.size() < most && std::abs(g.back()) > share * size) {
    Vectors w = product(basis.back());
    std::vector<double> column;
    for (const Vectors& u : basis) {
      column.push_back(inner(u, w));
      for (size_t i = 0; i < w.size(); ++i) w[i] -= column.back() * u[i];
    }
    const double left = std::sqrt(inner(w, w));
    for (size_t k = 0; k < c.size(); ++k) {
      const double p = column[k], q = column[k + 1];
      column[k] = c[k] * p + s[k] * q, column[k + 1] = -s[k] * p + c[k] * q;
    }
    const double r = std::hypot(column.back(), left);
    if (!(r > 0)) break;
    c.push_back(column.back() / r), s.push_back(left / r);
    column.back() = r;
    h.push_back(std::move(column));
    g.push_back(-s.back() * g.back()), g[g.size() - 2] *= c.back();
    if (left <= 1e-14 * r) break;
    for (Vec3& u : w) u *= 1 / left;
    basis.push_back(std::move(w));
  }
  std::vector<double> y(h.size());
  for (size_t k = h.size(); k-- > 0;) {
    y[k] = g[k];
    for (size_t j = k + 1; j < h.size(); ++j) y[k] -= h[j][k] * y[j];
    y[k] /= h[k][k];
  }
  for (size_t k = 0; k < y.size(); ++k)
    for (size_t i = 0; i < x.size(); ++i) x[i] += y[k] * basis[k][i];
  return x;
}

}  // namespace

void implicit_velocities_together(const Accelerations& a, double t, double h, std::span<const Vec3> x, std::span<const Vec3> v,
                                  std::vector<Vec3>& w) {
  const size_t n = x.size();
  w.assign(v.begin(), v.end());
  Vectors at(n), pull(n);
  const auto left = [&](const Vectors& u) {  // v + h a(x + h u, u) - u
    for (size_t i = 0; i < n; ++i) at[i] = x[i] + h * u[i];
    a(at, u, t + h, pull);
    Vectors r(n);
    for (size_t i = 0; i < n; ++i) r[i] = v[i] + h * pull[i] - u[i];
    return r;
  };
  const double far = std::sqrt(inner({x.begin(), x.end()}, {x.begin(), x.end()}));
  double last = HUGE_VAL;
  for (int round = 0; round < 30; ++round) {
    const Vectors r = left(w);
    const double size = std::sqrt(inner(w, w));
    const auto product = [&](const Vectors& d) {
      const double width = 1e-6 * (1 + size) / std::max(1e-300, std::sqrt(inner(d, d)));
      Vectors up = w, down = w;
      for (size_t i = 0; i < n; ++i) up[i] += width * d[i], down[i] -= width * d[i];
      up = left(up), down = left(down);
      for (size_t i = 0; i < n; ++i) up[i] = (-1 / (2 * width)) * (up[i] - down[i]);
      return up;
    };
    const Vectors d = gmres(product, r, 1e-8);
    for (size_t i = 0; i < n; ++i) w[i] += d[i];
    const double change = std::sqrt(inner(d, d));
    if (change <= 1e-14 * size || h * change <= 1e-15 * far || (change >= last && change <= 1e-9 * size)) return;
    if (!std::isfinite(change)) break;
    last = change;
  }
  fail_data("Newton's method found no end of a step", "backward_euler", "shorter steps or another integrator");
}

}  // namespace sg::swarm
