// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/bodies/nbody.h"

#include <cmath>
#include <cstring>
#include <numbers>

#include "base/parallel.h"
#include "support/property.h"
#include "support/test.h"

using namespace sg;
using namespace sg::swarm;

namespace {

struct Crowd {
  std::vector<Vec3> x;
  std::vector<double> mass;
};
Crowd crowd(int n) {
  Crowd c;
  test::Random random(7);
  for (int i = 0; i < n; ++i) {
    c.x.emplace_back(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1));
    c.x.back() *= random.unit();
    c.mass.push_back(random.in(0.5, 2));
  }
  return c;
}

}  // namespace

TEST_CASE("nbody: two bodies follow Kepler's ellipse, to the order of each integrator") {
  // Relative orbit of eccentricity e = 0.3, semi-axis 1 about the mass 1 + 0.5: from the near end x = 1 - e.
  const double e = 0.3, all = 1.5, time = 2.5, rate = std::sqrt(all);
  double E = rate * time;
  for (int k = 0; k < 50; ++k) E -= (E - e * std::sin(E) - rate * time) / (1 - e * std::cos(E));
  const Vec3 want(std::cos(E) - e, std::sqrt(1 - e * e) * std::sin(E), 0);
  const double v = std::sqrt(all * (1 + e) / (1 - e)), x = 1 - e;
  Context context;
  for (const Integrator scheme :
       {Integrator::forward_euler, Integrator::backward_euler, Integrator::symplectic_euler, Integrator::verlet, Integrator::rk4}) {
    double h[4], error[4];
    for (int k = 0; k < 4; ++k) {
      NbodyParams p;
      p.bodies = {-x / 3, 0, 0, 0, -v / 3, 0, 1, 2 * x / 3, 0, 0, 0, 2 * v / 3, 0, 0.5};
      p.softening = 0, p.integrator = scheme;
      const int n = (order_of(scheme) == 1 ? 4000 : 250) << k;
      h[k] = time / n;
      NbodyRun run(p, context);
      for (int i = 0; i < n; ++i) run.step(h[k], context);
      error[k] = length(run.places()[1] - run.places()[0] - want);
    }
    CAPTURE(int(scheme));
    CAPTURE(error[3]);
    CHECK(std::abs(test::observed_order(h, error, 4) - order_of(scheme)) < 0.2);
  }
}

TEST_CASE("nbody: the direct sum keeps momentum and angular momentum") {
  NbodyParams p;
  p.count = 300, p.angle = 0, p.time = 1, p.softening = 0.02;
  Context context;
  const DatasetPtr d = nbody(p, context);
  const Array &m = d->fields().require("momentum").array, &l = d->fields().require("angular momentum").array;
  REQUIRE(m.count() == 26);
  double scale = 0;
  for (int c = 0; c < 3; ++c) scale = std::max(scale, std::abs(l.get(0, c)));
  for (size_t i = 0; i < m.count(); ++i)
    for (int c = 0; c < 3; ++c) {
      CHECK(std::abs(m.get(i, c) - m.get(0, c)) < 1e-13);
      CHECK(std::abs(l.get(i, c) - l.get(0, c)) < 1e-12 * (1 + scale));
    }
  const Array& total = d->fields().require("total").array;
  CHECK(std::abs(total.get(25) - total.get(0)) < 2e-3 * std::abs(total.get(0)));
}

TEST_CASE("nbody: the tree's error falls with the opening angle, and at angle 0 it is the direct sum") {
  const Crowd c = crowd(3000);
  std::vector<Vec3> exact(c.x.size()), a(c.x.size());
  std::vector<double> exact_potential(c.x.size()), potential(c.x.size());
  Pull pull{1, 0.01, 0};
  pull_directly(pull, c.x, c.mass, exact, exact_potential);
  const Octree tree(c.x, c.mass);
  double last = HUGE_VAL;
  for (const double angle : {1.0, 0.7, 0.5, 0.35, 0.2, 0.0}) {
    pull.angle = angle;
    tree.pull(pull, a, potential);
    double sum = 0, size = 0, energy = 0;
    for (size_t i = 0; i < a.size(); ++i) {
      sum += dot(a[i] - exact[i], a[i] - exact[i]), size += dot(exact[i], exact[i]);
      energy = std::max(energy, std::abs(potential[i] / exact_potential[i] - 1));
    }
    const double error = std::sqrt(sum / size);
    MESSAGE("angle " << angle << ": error " << error);
    CHECK(error < last * 0.75);
    CHECK(error < 0.04 * angle * angle + 1e-13);
    CHECK(energy < 0.02 * angle * angle + 1e-12);
    last = error;
  }
}

TEST_CASE("nbody: bodies in one place, one body, and bodies far from zero") {
  std::vector<Vec3> x(50, Vec3(1, 2, 3)), a(50);
  std::vector<double> m(50, 1);
  Octree(x, m).pull({1, 0, 0.5}, a);
  for (const Vec3& v : a) CHECK(v == Vec3(0, 0, 0));
  std::vector<Vec3> one{{0, 0, 0}}, b(1);
  Octree(one, std::vector<double>{1}).pull({}, b);
  CHECK(b[0] == Vec3(0, 0, 0));
  std::vector<Vec3> two{{1e9, 0, 0}, {1e9 + 2, 0, 0}}, d(2);
  Octree(two, std::vector<double>{1, 4}).pull({}, d);
  CHECK(d[0].x == 1);
  CHECK(d[1].x == -0.25);
}

TEST_CASE("nbody: clusters are in balance, and the same bytes come from any number of threads") {
  NbodyParams p;
  p.clusters = 1, p.count = 4000, p.softening = 0.01, p.time = 0.4;
  Context context;
  set_thread_count(1);
  const DatasetPtr d = nbody(p, context);
  p.time = 0;
  nbody(p, context);
  p.time = 0.4;
  set_thread_count(2);
  const DatasetPtr e = nbody(p, context);
  set_thread_count(0);
  const Array &u = d->as<PointCloud>()->points.xyz, &v = e->as<PointCloud>()->points.xyz;
  CHECK(std::memcmp(u.raw(), v.raw(), u.bytes()) == 0);
  // Plummer's model: U = -3 pi / 32, and twice the kinetic energy is -U; sampling leaves a few percent.
  const double k = d->fields().require("kinetic").array.get(0), w = d->fields().require("potential energy").array.get(0);
  CHECK(w == doctest::Approx(-3 * std::numbers::pi / 32).epsilon(0.05));
  CHECK(-2 * k / w == doctest::Approx(1).epsilon(0.05));
}

TEST_CASE("nbody: what cannot be is said") {
  Context context;
  const auto refused = [&](const NbodyParams& p) { return test::error_of([&] { nbody(p, context); }); };
  NbodyParams p;
  p.bodies = {0, 0, 0, 0, 0, 0, -1};
  CHECK(test::contains(refused(p), "mass -1"));
  p.bodies = {0, 0, 0, 0, 0, 0, 0};
  CHECK(test::contains(refused(p), "masses are above 0"));
  p.bodies = {NAN, 0, 0, 0, 0, 0, 1};
  CHECK(test::contains(refused(p), "not finite"));
  p.bodies = {1, 2};
  CHECK(test::contains(refused(p), "2 numbers"));
  p.bodies = {}, p.step = HUGE_VAL;
  CHECK(test::contains(refused(p), "finite"));
  p.step = 0.01;
  p.bodies = {0, 0, 0, 0, 0, 0, 1e200, 1e-60, 0, 0, 0, 0, 0, 1e200};
  p.softening = 0, p.time = 1;
  CHECK(test::contains(refused(p), "beyond all numbers in frame"));
}
