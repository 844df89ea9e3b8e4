// SPDX-License-Identifier: Apache-2.0
// The integrators of particles against closed forms.
#include "simulate/particles/scheme.h"

#include <cmath>
#include <numbers>

#include "support/test.h"

using namespace sg;
using namespace sg::swarm;

namespace {

constexpr Integrator all_integrators[] = {Integrator::forward_euler, Integrator::backward_euler, Integrator::symplectic_euler,
                                          Integrator::verlet, Integrator::rk4};

struct Orbiter {
  std::vector<Vec3> x{{1, 0, 0}}, v;
  Scratch scratch;
  double energy() const { return dot(v[0], v[0]) / 2 - 1 / length(x[0]); }
  void step(Integrator scheme, double h) {
    const auto pull = [](std::span<const Vec3> at, std::span<const Vec3>, double, std::span<Vec3> a) {
      for (size_t i = 0; i < at.size(); ++i) a[i] = at[i] * (-1 / std::pow(dot(at[i], at[i]), 1.5));
    };
    advance(scheme, pull, 0, h, x, v, scratch);
  }
};

}  // namespace

TEST_CASE("particles: every integrator has its order on a damped oscillator, alone and coupled") {
  // x'' = -x - 0.4 x': x = exp(-t/5) (cos wt + sin wt / (5w)), w^2 = 1 - 1/25.
  const double time = 2, w = std::sqrt(0.96), want = std::exp(-0.2 * time) * (std::cos(w * time) + 0.2 / w * std::sin(w * time));
  const auto pull = [](std::span<const Vec3> x, std::span<const Vec3> v, double, std::span<Vec3> a) {
    for (size_t i = 0; i < x.size(); ++i) a[i] = -x[i] - 0.4 * v[i];
  };
  for (const Integrator scheme : all_integrators)
    for (const bool coupled : {false, true}) {
      double h[4], error[4];
      for (int k = 0; k < 4; ++k) {
        const int n = 40 << k;
        h[k] = time / n;
        std::vector<Vec3> x{{1, 0, 0}, {0, 1, -2}}, v(2);
        Scratch scratch;
        for (int i = 0; i < n; ++i) advance(scheme, pull, i * h[k], h[k], x, v, scratch, coupled);
        error[k] = std::abs(x[0].x - want);
        CHECK(x[1].y == doctest::Approx(x[0].x).epsilon(1e-12));
        CHECK(x[1].z == doctest::Approx(-2 * x[0].x).epsilon(1e-12));
      }
      CAPTURE(int(scheme));
      CHECK(std::abs(test::observed_order(h, error, 4) - order_of(scheme)) < 0.15);
    }
}

TEST_CASE("particles: symplectic Euler keeps the energy of an orbit bounded over 10,000 turns, forward gains, backward loses") {
  // Eccentricity 0.5: x = 1 is the near end, v^2 = 1.5, E = -1/4, a turn takes 2 pi 2^(3/2). 400 steps a turn.
  const double h = 2 * std::numbers::pi * std::pow(2, 1.5) / 400;
  for (const auto scheme : {Integrator::symplectic_euler, Integrator::verlet}) {
    Orbiter o;
    o.v = {{0, std::sqrt(1.5), 0}};
    double in_ten = 0, in_all = 0;
    for (int turn = 0; turn < 10000; ++turn) {
      for (int i = 0; i < 400; ++i) {
        o.step(scheme, h);
        in_all = std::max(in_all, std::abs(o.energy() + 0.25));
      }
      if (turn == 9) in_ten = in_all;
    }
    MESSAGE("energy error of 10 turns " << in_ten << ", of 10,000 " << in_all << ", at their end " << o.energy() + 0.25);
    CHECK(in_ten < (scheme == Integrator::verlet ? 2e-3 : 2.5e-2));
    CHECK(in_all < 1.05 * in_ten);  // no drift: the first ten turns show all of it
  }
  Orbiter gains, loses;
  gains.v = loses.v = {{0, std::sqrt(1.5), 0}};
  for (int i = 0; i < 400; ++i) gains.step(Integrator::forward_euler, h);
  MESSAGE("energy after one turn of forward Euler " << gains.energy());
  CHECK(gains.energy() > -0.25 * 0.8);
  for (int i = 0; i < 40; ++i) loses.step(Integrator::backward_euler, h);
  MESSAGE("energy after a tenth of a turn of backward Euler " << loses.energy());
  CHECK(loses.energy() < -0.25 * 1.2);
}

TEST_CASE("particles: backward Euler stands a stiff drag at any step") {
  const auto pull = [](std::span<const Vec3>, std::span<const Vec3> v, double, std::span<Vec3> a) {
    for (size_t i = 0; i < v.size(); ++i) a[i] = Vec3(0, 0, -9.81) - 1e4 * v[i];
  };
  std::vector<Vec3> x(1), v{{5, 0, 0}};
  Scratch scratch;
  for (int i = 0; i < 10; ++i) advance(Integrator::backward_euler, pull, 0, 1, x, v, scratch);
  CHECK(v[0].z == doctest::Approx(-9.81e-4).epsilon(1e-9));
  CHECK(std::abs(v[0].x) < 1e-30);
}
