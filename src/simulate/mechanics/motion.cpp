// SPDX-License-Identifier: Apache-2.0
#include "simulate/mechanics/motion.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "simulate/mechanics/solve.h"

namespace sg::mechanics {

namespace {

Numbers plus(const Numbers& a, double s, const Numbers& b) {
  Numbers r = a;
  for (size_t i = 0; i < r.size(); ++i) r[i] += s * b[i];
  return r;
}

double largest(const Numbers& a) {
  double m = 0;
  for (const double v : a) m = std::abs(v) <= m ? m : std::abs(v);  // NaN stays
  return m;
}

}  // namespace

Motion::Motion(std::shared_ptr<const System> system) : system_(std::move(system)), last_speed_(size_t(system_->size()), 0) {}

Motion::Slopes Motion::slopes(const Numbers& q, const Numbers& v, const std::vector<Direction>& directions) {
  const size_t n = q.size(), count = directions.size();
  Slopes s;
  s.by_q_along.assign(count, Numbers(n)), s.by_v_along.assign(count, Numbers(n));
  std::vector<Traced> tq(n), tv(n);
  for (size_t first = 0; first == 0 || first < count; first += lanes) {
    tape_.clear();
    const size_t here = std::min<size_t>(lanes, count - first);
    const auto put = [&](std::vector<Traced>& to, const Numbers& from, Numbers Direction::*part) {
      for (size_t i = 0; i < n; ++i) {
        Along x(from[i]);
        for (size_t k = 0; k < here; ++k) x.d[k] = (directions[first + k].*part)[i];
        to[i] = tape_.input(x);
      }
    };
    put(tq, q, &Direction::q), put(tv, v, &Direction::v);
    const Traced l = system_->lagrangian(tq, tv);
    const std::vector<Along>& slope = tape_.adjoints(l);
    s.by_q.resize(n), s.by_v.resize(n);
    for (size_t i = 0; i < n; ++i) {
      const Along a = slope[size_t(tq[i].node)], b = slope[size_t(tv[i].node)];
      s.by_q[i] = a.value, s.by_v[i] = b.value;
      for (size_t k = 0; k < here; ++k) s.by_q_along[first + k][i] = a.d[k], s.by_v_along[first + k][i] = b.d[k];
    }
  }
  return s;
}

namespace {

[[noreturn]] void fail_singular(const System& system, int coordinate) {
  fail_usage(fmt::format("the mass matrix is singular: the kinetic energy does not tell how '{}' moves", system.coordinate(coordinate)),
             "mechanics", "every coordinate needs a mass of its own");
}

}  // namespace

Numbers Motion::mass_matrix(const Numbers& q, const Numbers& v) {
  const size_t n = q.size();
  std::vector<Direction> directions(n, {Numbers(n), Numbers(n)});
  for (size_t i = 0; i < n; ++i) directions[i].v[i] = 1;
  const Slopes s = slopes(q, v, directions);
  Numbers m(n * n);
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < n; ++j) m[i * n + j] = s.by_v_along[j][i];
  return m;
}

State Motion::state(const Numbers& q, const Numbers& v) {
  Numbers any(q.size(), 1);
  if (const int bad = solve(mass_matrix(q, v), any); bad >= 0) fail_singular(*system_, bad);
  last_speed_ = v;
  return {q, slopes(q, v, {}).by_v};
}

Numbers Motion::acceleration(const Numbers& q, const Numbers& v) {
  const Slopes s = slopes(q, v, {{v, Numbers(q.size())}});
  Numbers a = plus(s.by_q, -1, s.by_v_along[0]);
  if (const int bad = solve(mass_matrix(q, v), a); bad >= 0) fail_singular(*system_, bad);
  return a;
}

// The w at which dL/dv(base + alpha w, w) - beta dL/dq(base + alpha w, w) = rhs.
Numbers Motion::solve_momenta(const Numbers& base, double alpha, double beta, const Numbers& rhs, Numbers w) {
  const size_t n = base.size();
  std::vector<Direction> directions(n, {Numbers(n), Numbers(n)});
  for (size_t i = 0; i < n; ++i) directions[i].q[i] = alpha, directions[i].v[i] = 1;
  double last = HUGE_VAL;
  for (int round = 0; round < 50; ++round) {
    const Slopes s = slopes(plus(base, alpha, w), w, directions);
    Numbers left(n), matrix(n * n);
    for (size_t i = 0; i < n; ++i) {
      left[i] = rhs[i] - (s.by_v[i] - beta * s.by_q[i]);
      for (size_t j = 0; j < n; ++j) matrix[i * n + j] = s.by_v_along[j][i] - beta * s.by_q_along[j][i];
    }
    if (largest(left) == 0) return w;
    if (!std::isfinite(largest(left)))
      fail_data("the motion grew beyond all numbers", "mechanics", "take shorter steps or another integrator");
    if (const int bad = solve(std::move(matrix), left); bad >= 0) {
      if (alpha == 0 && beta == 0) fail_singular(*system_, bad);
      fail_data("Newton's method met a singular matrix", "mechanics", "shorter steps or another integrator");
    }
    const double change = largest(left), size = largest(w);
    w = plus(w, 1, left);
    // Until rounding is all that changes; quadratic convergence has then long passed.
    if (change <= 4e-16 * size || (change >= last && change <= 1e-10 * size)) return w;
    if (round > 3 && change <= 1e-13 * size) return w;
    last = change;
  }
  fail_data("Newton's method found no end of a step", "mechanics", "shorter steps or another integrator");
}

Numbers Motion::speed(const State& s) {
  Numbers v = solve_momenta(s.q, 0, 0, s.p, last_speed_);
  last_speed_ = v;
  return v;
}

std::array<double, 2> Motion::energies(const State& s) {
  const Numbers v = speed(s);
  return {system_->kinetic(s.q, v), system_->potential(s.q)};
}

void Motion::step(Integrator scheme, double h, State& s) {
  const auto force = [&](const Numbers& q, const Numbers& v) { return slopes(q, v, {}).by_q; };
  switch (scheme) {
    case Integrator::forward_euler: {
      const Numbers v = speed(s), f = force(s.q, v);
      s.q = plus(s.q, h, v), s.p = plus(s.p, h, f);
      return;
    }
    case Integrator::symplectic_euler: {
      const Numbers w = solve_momenta(s.q, 0, h, s.p, last_speed_);
      s.p = plus(s.p, h, force(s.q, w)), s.q = plus(s.q, h, w);
      last_speed_ = w;
      return;
    }
    case Integrator::backward_euler: {
      const Numbers w = solve_momenta(s.q, h, h, s.p, last_speed_);
      s.q = plus(s.q, h, w), s.p = plus(s.p, h, force(s.q, w));
      last_speed_ = w;
      return;
    }
    case Integrator::verlet: {
      const Numbers w = solve_momenta(s.q, 0, h / 2, s.p, last_speed_);
      const Numbers half = plus(s.p, h / 2, force(s.q, w));
      const Numbers base = plus(s.q, h / 2, w);
      const Numbers u = solve_momenta(base, h / 2, 0, half, w);
      s.q = plus(base, h / 2, u), s.p = plus(half, h / 2, force(s.q, u));
      last_speed_ = u;
      return;
    }
    case Integrator::rk4: {
      Numbers vs[4], fs[4];
      for (int k = 0; k < 4; ++k) {
        const double share = k == 0 ? 0 : k == 3 ? h : h / 2;
        State at = s;
        if (k) at.q = plus(s.q, share, vs[k - 1]), at.p = plus(s.p, share, fs[k - 1]);
        vs[k] = speed(at), fs[k] = force(at.q, vs[k]);
      }
      for (int k = 0; k < 4; ++k) {
        const double weight = h / (k == 0 || k == 3 ? 6 : 3);
        s.q = plus(s.q, weight, vs[k]), s.p = plus(s.p, weight, fs[k]);
      }
      return;
    }
  }
}

}  // namespace sg::mechanics
