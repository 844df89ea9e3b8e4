// SPDX-License-Identifier: Apache-2.0
// A step in time of particles x'' = a(x, x', t), by every integrator. Forces are anything with
//   void operator()(std::span<const Vec3> x, std::span<const Vec3> v, double t, std::span<Vec3> a)
#pragma once
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "base/vec.h"
#include "simulate/particles/krylov.h"
#include "simulate/run/integrator.h"

namespace sg::swarm {

/// Memory that steps use again.
struct Scratch {
  std::vector<Vec3> a, x, v, k[2], sum[2];
};

namespace detail {

// Solves J d = r for a 3x3 matrix by Cramer's rule; where J is singular d = r, as if nothing pulled.
inline Vec3 solve3(const Vec3 (&column)[3], Vec3 r) {
  const double det = dot(column[0], cross(column[1], column[2]));
  if (!(std::abs(det) > 1e-30)) return r;
  return Vec3(dot(r, cross(column[1], column[2])), dot(column[0], cross(r, column[2])), dot(column[0], cross(column[1], r))) * (1 / det);
}

// The velocities w with w = v + h a(x + h w, w): Newton's method with a 3x3 matrix for each particle, from central differences.
template <class F>
void implicit_velocities(F&& f, double t, double h, std::span<const Vec3> x, std::span<const Vec3> v, std::vector<Vec3>& w, Scratch& s) {
  const size_t n = x.size();
  w.assign(v.begin(), v.end());
  s.a.resize(n), s.x.resize(n), s.k[0].resize(n), s.k[1].resize(n);
  std::vector<Vec3> columns(3 * n), at(n);
  const auto accelerations = [&](std::span<const Vec3> u, std::vector<Vec3>& a) {
    for (size_t i = 0; i < n; ++i) s.x[i] = x[i] + h * u[i];
    f(std::span<const Vec3>(s.x), u, t + h, std::span<Vec3>(a));
  };
  double last = HUGE_VAL;
  for (int round = 0; round < 20; ++round) {
    accelerations(w, s.a);
    for (int c = 0; c < 3; ++c) {
      const auto width = [&](size_t i) { return 1e-6 * (1 + std::abs(w[i][c])); };
      for (const double sign : {1.0, -1.0}) {
        at = w;
        for (size_t i = 0; i < n; ++i) at[i][c] += sign * width(i);
        accelerations(at, s.k[sign < 0]);
      }
      for (size_t i = 0; i < n; ++i) {
        Vec3 column = (-h / (2 * width(i))) * (s.k[0][i] - s.k[1][i]);
        column[c] += 1;
        columns[3 * i + size_t(c)] = column;
      }
    }
    double change = 0;
    for (size_t i = 0; i < n; ++i) {
      const Vec3 left = v[i] + h * s.a[i] - w[i];
      const Vec3 d = solve3({columns[3 * i], columns[3 * i + 1], columns[3 * i + 2]}, left);
      w[i] += d;
      change = std::max(change, length(d) / (1e-3 + length(w[i])));
    }
    if (change < 1e-14 || (change < 1e-11 && change >= last)) return;
    last = change;
  }
}

}  // namespace detail

/// Moves x and v on by h. `coupled`: the acceleration of one particle depends on others, so that backward_euler solves for all together
/// (Newton's method with GMRES). Verlet with forces that depend on velocity takes them at the velocity that Euler's rule predicts: order 2.
template <class F>
void advance(Integrator scheme, F&& f, double t, double h, std::span<Vec3> x, std::span<Vec3> v, Scratch& s, bool coupled = false) {
  const size_t n = x.size();
  const auto accelerations = [&](std::span<const Vec3> at, std::span<const Vec3> speed, double time, std::vector<Vec3>& a) {
    a.resize(n);
    f(at, speed, time, std::span<Vec3>(a));
  };
  switch (scheme) {
    case Integrator::forward_euler:
      accelerations(x, v, t, s.a);
      for (size_t i = 0; i < n; ++i) x[i] += h * v[i], v[i] += h * s.a[i];
      return;
    case Integrator::symplectic_euler:
      accelerations(x, v, t, s.a);
      for (size_t i = 0; i < n; ++i) v[i] += h * s.a[i], x[i] += h * v[i];
      return;
    case Integrator::backward_euler:
      if (coupled) implicit_velocities_together(f, t, h, x, v, s.v);
      else detail::implicit_velocities(f, t, h, x, v, s.v, s);
      for (size_t i = 0; i < n; ++i) v[i] = s.v[i], x[i] += h * v[i];
      return;
    case Integrator::verlet: {
      accelerations(x, v, t, s.a);
      s.v.resize(n);
      for (size_t i = 0; i < n; ++i) x[i] += h * v[i] + (h * h / 2) * s.a[i], s.v[i] = v[i] + h * s.a[i];
      accelerations(x, s.v, t + h, s.k[0]);
      for (size_t i = 0; i < n; ++i) v[i] += (h / 2) * (s.a[i] + s.k[0][i]);
      return;
    }
    case Integrator::rk4: {
      s.x.assign(x.begin(), x.end()), s.v.assign(v.begin(), v.end());
      s.sum[0].assign(n, {}), s.sum[1].assign(n, {});
      for (int stage = 0; stage < 4; ++stage) {
        const double at = stage == 0   ? 0
                          : stage == 3 ? h
                                       : h / 2,
                     weight = h / (stage == 0 || stage == 3 ? 6 : 3), next = stage == 2 ? h : h / 2;
        accelerations(s.x, s.v, t + at, s.a);
        for (size_t i = 0; i < n; ++i) {
          s.sum[0][i] += weight * s.v[i], s.sum[1][i] += weight * s.a[i];
          const Vec3 speed = s.v[i];
          s.x[i] = x[i] + next * speed, s.v[i] = v[i] + next * s.a[i];
        }
      }
      for (size_t i = 0; i < n; ++i) x[i] += s.sum[0][i], v[i] += s.sum[1][i];
      return;
    }
  }
}

}  // namespace sg::swarm
