// SPDX-License-Identifier: Apache-2.0
#include "simulate/mechanics/mechanics.h"

#include <array>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "simulate/mechanics/examples.h"
#include "support/property.h"
#include "support/test.h"

using namespace sg;
using namespace sg::mechanics;

namespace {

MechanicsParams of(MechanicalSystem system) {
  MechanicsParams p;
  p.system = system;
  return p;
}

MechanicsParams by_expression(std::vector<std::string> names, std::string kinetic, std::string potential) {
  MechanicsParams p = of(MechanicalSystem::expression);
  p.coordinates = std::move(names), p.kinetic = std::move(kinetic), p.potential = std::move(potential);
  return p;
}

// The double pendulum's angular accelerations as textbooks solve them (masses and lengths 1).
using Four = std::array<double, 4>;
Four double_pendulum_slope(const Four& y) {
  const double g = 9.81, a = y[0], b = y[1], u = y[2], w = y[3], d = a - b, s = std::sin(d), c = std::cos(d), below = 3 - std::cos(2 * d);
  return {u, w, (-3 * g * std::sin(a) - g * std::sin(a - 2 * b) - 2 * s * (w * w + u * u * c)) / below,
          2 * s * (2 * u * u + 2 * g * std::cos(a) + w * w * c) / below};
}

// By classic RK4 of our own, with far smaller steps, extrapolated (Richardson).
Four double_pendulum_reference(Four y0, double time) {
  const auto run = [&](int n) {
    Four y = y0;
    const double h = time / n;
    const auto moved = [&](const Four& k, double s) {
      Four r = y;
      for (size_t i = 0; i < 4; ++i) r[i] += s * k[i];
      return r;
    };
    for (int i = 0; i < n; ++i) {
      const Four k1 = double_pendulum_slope(y), k2 = double_pendulum_slope(moved(k1, h / 2)), k3 = double_pendulum_slope(moved(k2, h / 2)),
                 k4 = double_pendulum_slope(moved(k3, h));
      for (size_t j = 0; j < 4; ++j) y[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
    }
    return y;
  };
  const Four coarse = run(4000);
  Four fine = run(8000);
  for (size_t i = 0; i < 4; ++i) fine[i] += (fine[i] - coarse[i]) / 15;
  return fine;
}

}  // namespace

TEST_CASE("mechanics: accelerations of the double pendulum are those of its closed equations") {
  Motion motion(system_of(of(MechanicalSystem::double_pendulum)));
  for (const uint64_t seed : test::property_seeds(50)) {
    test::Random random(seed);
    const Four y{random.in(-3, 3), random.in(-3, 3), random.in(-5, 5), random.in(-5, 5)};
    const Numbers a = motion.acceleration({y[0], y[1]}, {y[2], y[3]});
    const Four want = double_pendulum_slope(y);
    for (size_t i = 0; i < 2; ++i) CHECK(std::abs(a[i] - want[i + 2]) <= 1e-12 * (1 + std::abs(want[i + 2])) * 10);
    const Numbers m = motion.mass_matrix({y[0], y[1]}, {y[2], y[3]});
    CHECK(m[0] == doctest::Approx(2).epsilon(1e-14));
    CHECK(m[1] == doctest::Approx(std::cos(y[0] - y[1])).epsilon(1e-13));
    CHECK(m[2] == m[1]);
    CHECK(m[3] == doctest::Approx(1).epsilon(1e-14));
  }
}

TEST_CASE("mechanics: every integrator has its order on the double pendulum, against a far finer reference") {
  const Four y0{1.5, 2.2, 0.3, -0.4};
  const double time = 1;
  const Four want = double_pendulum_reference(y0, time);
  for (const Integrator scheme :
       {Integrator::forward_euler, Integrator::backward_euler, Integrator::symplectic_euler, Integrator::verlet, Integrator::rk4}) {
    double h[4], error[4];
    for (int k = 0; k < 4; ++k) {
      const int n = (order_of(scheme) == 1 ? 800 : 100) << k;
      h[k] = time / n;
      Motion motion(system_of(of(MechanicalSystem::double_pendulum)));
      State s = motion.state({y0[0], y0[1]}, {y0[2], y0[3]});
      for (int i = 0; i < n; ++i) motion.step(scheme, h[k], s);
      error[k] = std::hypot(s.q[0] - want[0], s.q[1] - want[1]);
    }
    CAPTURE(int(scheme));
    CAPTURE(error[3]);
    const double order = test::observed_order(h, error, 4);
    CHECK(std::abs(order - order_of(scheme)) < 0.2);
  }
}

TEST_CASE("mechanics: a pendulum's period is the elliptic integral") {
  for (const double swing : {0.1, 1.0, 2.5, 3.0}) {
    MechanicsParams p = of(MechanicalSystem::pendulum);
    p.start = {swing}, p.length = {0.7}, p.mass = {3};
    Motion motion(system_of(p));
    State s = motion.state({swing}, {0});
    const double period = 4 * std::sqrt(0.7 / 9.81) * std::comp_ellint_1(std::sin(swing / 2));
    const int n = 2000;
    for (int i = 0; i < n; ++i) motion.step(Integrator::rk4, period / n, s);
    // After a whole period it is back; p = m l^2 q'.
    CHECK(std::abs(s.q[0] - swing) < 1e-8);
    CHECK(std::abs(s.p[0]) < 1e-7);
    for (int i = 0; i < n / 4; ++i) motion.step(Integrator::rk4, period / n, s);
    CHECK(std::abs(s.q[0]) < 1e-7);
  }
}

TEST_CASE("mechanics: forward Euler gains energy, backward Euler loses it, symplectic Euler and Verlet keep it bounded") {
  const auto run = [](Integrator scheme, int turns, int steps) {
    MechanicsParams p = of(MechanicalSystem::orbit);
    p.speed = {0, 1};
    Motion motion(system_of(p));
    State s = motion.state({1, 0}, {0, 1});
    double most = -HUGE_VAL, least = HUGE_VAL;
    for (int i = 0; i < turns * steps; ++i) {
      motion.step(scheme, 2 * std::numbers::pi / steps, s);
      const auto e = motion.energies(s);
      most = std::max(most, e[0] + e[1]), least = std::min(least, e[0] + e[1]);
    }
    return std::array{least, most};
  };
  // On a circle of radius r about a pull of 1 a step of forward Euler adds h^2 (a^2 + v^2/r^3)/2 = h^2/r^4 to the energy -1/(2r), backward
  // Euler takes as much: r^3 = 1 +- 6 h t.
  const double ht = 4 * std::numbers::pi * std::numbers::pi / 1000;
  CHECK(run(Integrator::forward_euler, 1, 1000)[1] == doctest::Approx(-0.5 / std::cbrt(1 + 6 * ht)).epsilon(0.005));
  CHECK(run(Integrator::backward_euler, 1, 1000)[0] == doctest::Approx(-0.5 / std::cbrt(1 - 6 * ht)).epsilon(0.005));
  for (const auto& [scheme, bound] : {std::pair{Integrator::symplectic_euler, 5e-3}, {Integrator::verlet, 5e-6}}) {
    const auto [least, most] = run(scheme, 100, 100);
    CHECK(std::abs(least + 0.5) < bound);
    CHECK(std::abs(most + 0.5) < bound);
  }
}

TEST_CASE("mechanics: energies in expressions move as those of functors do") {
  MechanicsParams p = by_expression({"a", "b"}, "a_dot^2 + b_dot^2/2 + a_dot*b_dot*cos(a-b)", "-2*9.81*cos(a) - 9.81*cos(b)");
  p.places = "sin(a); -cos(a); 0; sin(a)+sin(b); -cos(a)-cos(b); 0";
  p.start = {2.2, 2.2}, p.time = 0.4;
  MechanicsParams q = of(MechanicalSystem::double_pendulum);
  q.time = p.time;
  Context context;
  const DatasetPtr d = mechanics_source(p, context), e = mechanics_source(q, context);
  REQUIRE(d->point_count() == e->point_count());
  const Array &u = d->fields().require("velocity").array, &v = e->fields().require("velocity").array;
  for (size_t i = 0; i < u.count(); ++i)
    for (int a = 0; a < 3; ++a) CHECK(std::abs(u.get(i, a) - v.get(i, a)) < 1e-9);
  CHECK(e->fields().require("total").array.count() == 11);
  CHECK((e->fields().require("moment").array.get(10) == doctest::Approx(0.4) && *e->time() == doctest::Approx(0.4)));
  // Three bodies, two rods, a trail of ten frames of eight marks and the first.
  CHECK(e->as<SurfaceMesh>()->lines.size() == 3);
  CHECK(e->point_count() == 3 + 81);
}

TEST_CASE("mechanics: a bead on a parabola, whose mass depends on the coordinate, keeps its energy under Verlet") {
  MechanicsParams p = by_expression({"s"}, "(1 + 4*s^2) * s_dot^2 / 2", "9.81*s^2");
  Motion motion(system_of(p));
  double h[4], drift[4];
  for (int k = 0; k < 4; ++k) {
    State s = motion.state({1}, {0});
    h[k] = 0.02 / (1 << k), drift[k] = 0;
    for (int i = 0; i < int(20 / h[k]); ++i) {
      motion.step(Integrator::verlet, h[k], s);
      const auto e = motion.energies(s);
      drift[k] = std::max(drift[k], std::abs(e[0] + e[1] - 9.81));
    }
  }
  CHECK(test::observed_order(h, drift, 4) == doctest::Approx(2).epsilon(0.1));
  CHECK(drift[3] < 1e-3);
}

TEST_CASE("mechanics: a net of springs keeps its energy, hangs from its corners, and stays symmetric") {
  MechanicsParams p = of(MechanicalSystem::spring_net);
  p.size = 4, p.time = 0.4;
  Context context;
  const DatasetPtr d = mechanics_source(p, context);
  const Array& drift = d->fields().require("drift").array;
  for (size_t i = 0; i < drift.count(); ++i) CHECK(std::abs(drift.get(i)) < 0.01);
  const Points& at = d->as<SurfaceMesh>()->points;
  CHECK((at.at(12) == Vec3(0, 1, 0) && at.at(15) == Vec3(1, 1, 0)));
  CHECK(at.at(0).z < -0.1);
  for (size_t j = 0; j < 4; ++j)
    for (size_t i = 0; i < 2; ++i) CHECK(std::abs(at.at(4 * j + i).z - at.at(4 * j + 3 - i).z) < 1e-9);
}

TEST_CASE("mechanics: frames are the same bytes in any order of times") {
  MechanicsParams p = of(MechanicalSystem::double_pendulum);
  Context context;
  const auto at = [&](double time) {
    p.time = time;
    const Array v = mechanics_source(p, context)->fields().require("velocity").array;
    return std::vector<double>{v.get(1, 0), v.get(2, 0), v.get(2, 1)};
  };
  const auto late = at(2), early = at(1);
  const auto again = at(2);
  for (size_t i = 0; i < 3; ++i) CHECK(again[i] == late[i]);
  CHECK(at(1) == early);
}

TEST_CASE("mechanics: what cannot move is said") {
  Context context;
  const auto refused = [&](const MechanicsParams& p) { return test::error_of([&] { mechanics_source(p, context); }); };
  // The mass of b is missing; then M = (1 1; 1 1).
  MechanicsParams p = by_expression({"a", "b"}, "a_dot^2/2", "a^2 + b^2");
  CHECK(test::contains(refused(p), "the mass matrix is singular: the kinetic energy does not tell how 'b' moves"));
  p.kinetic = "(a_dot + b_dot)^2/2";
  CHECK(test::contains(refused(p), "singular"));
  p.kinetic = "a_dot^2 + c_dot^2";
  CHECK(test::contains(refused(p), "mechanics kinetic: 'c_dot"));
  p.kinetic = "a_dot^2 + mag(b_dot)";
  CHECK(test::contains(refused(p), "vectors"));
  p.coordinates = {"a", "a"};
  CHECK(test::contains(refused(p), "two"));
  p.coordinates = {};
  CHECK(test::contains(refused(p), "coordinates=a"));
  MechanicsParams q = of(MechanicalSystem::double_pendulum);
  q.mass = {1, -1};
  CHECK(test::contains(refused(q), "-1 is not positive"));
  q.mass = {1};
  CHECK(test::contains(refused(q), "2 are needed"));
  q.mass = {}, q.start = {NAN, 0};
  CHECK(test::contains(refused(q), "not finite"));
  q.start = {}, q.step = HUGE_VAL;
  CHECK(test::contains(refused(q), "step"));
  q.step = 0.01, q.frame = HUGE_VAL;
  CHECK(test::contains(refused(q), "frame"));
  q.frame = 1, q.time = 1, q.step = 1e-9;
  CHECK(test::contains(refused(q), "a million steps"));
  CHECK(test::contains(test::error_of([] {
                         MechanicsParams r;
                         Schema s = schema_of(r);
                         set_param(s, "step", "0", "mechanics");
                       }),
                       "above 0"));
  // An unstable run says when and why.
  MechanicsParams r = by_expression({"x1"}, "x1_dot^2/2", "-x1^4");
  r.start = {1}, r.time = 10, r.integrator = Integrator::forward_euler;
  const std::string why = refused(r);
  INFO(why);
  CHECK(test::contains(why, "the motion grew beyond all numbers"));
  CHECK(test::contains(why, "computing frame "));
}
