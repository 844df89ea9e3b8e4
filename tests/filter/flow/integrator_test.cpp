// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/integrator.h"

#include <numbers>

#include "base/context.h"
#include "filter/flow/flow_field.h"
#include "filter/flow/trace.h"
#include "filter/flow/trace_line.h"
#include "support/test.h"

using namespace sg;

namespace {

using std::numbers::pi;

// A flow whose velocity depends on place and time and whose path is known: a spiral around the z axis whose pitch is driven by cos t,
// x = e^{-t/10} (cos t, sin t), z = sin t.
Vec3 spiral_velocity(Vec3 x, double t) { return {-0.1 * x.x - x.y, x.x - 0.1 * x.y, std::cos(t)}; }
Vec3 spiral_place(double t) { return {std::exp(-t / 10) * std::cos(t), std::exp(-t / 10) * std::sin(t), std::sin(t)}; }

double error_of_spiral(Scheme scheme, int steps) {
  AnalyticFlow flow{spiral_velocity};
  const double h = 2.0 / steps;
  Vec3 x = spiral_place(0), v;
  for (int i = 0; i < steps; ++i) {
    const double t = i * h;
    flow(x, t, v);
    if (scheme == Scheme::dormand_prince) {
      DormandPrinceStep s;
      REQUIRE(dormand_prince_step(flow, x, t, h, v, s));
      x = s.x1;
    } else {
      REQUIRE(fixed_step(scheme, flow, x, t, h, v, x));
    }
  }
  return length(x - spiral_place(2));
}

}  // namespace

TEST_CASE("integrators: errors of a known unsteady path fall with the order of each scheme") {
  for (const Scheme s : {Scheme::euler, Scheme::midpoint, Scheme::heun, Scheme::rk4, Scheme::dormand_prince}) {
    const int n = s == Scheme::dormand_prince ? 8 : 16;
    double last = error_of_spiral(s, n);
    for (int k = 1; k <= 3; ++k) {
      const double now = error_of_spiral(s, n << k), order = std::log2(last / now);
      CAPTURE(int(s));
      CHECK(order == doctest::Approx(order_of(s)).epsilon(0.2 / order_of(s)));
      last = now;
    }
  }
}

TEST_CASE("integrators: the dense output of Dormand and Prince has order 4 between the ends of a step") {
  AnalyticFlow flow{spiral_velocity};
  double last = 0;
  for (int k = 0; k < 4; ++k) {
    const double h = 0.8 / (1 << k);
    DormandPrinceStep s;
    Vec3 v;
    flow(spiral_place(0.3), 0.3, v);
    REQUIRE(dormand_prince_step(flow, spiral_place(0.3), 0.3, h, v, s));
    double worst = 0;
    for (const double theta : {0.25, 0.5, 0.8}) worst = std::max(worst, length(s.at(theta) - spiral_place(0.3 + theta * h)));
    CHECK(length(s.at(0) - spiral_place(0.3)) < 1e-14);
    CHECK(length(s.at(1) - s.x1) < 1e-14);
    if (k > 0) CHECK(std::log2(last / worst) > 4.7);  // one step: an order more
    last = worst;
  }
}

TEST_CASE("trace: a rotation closes after 2 pi") {
  AnalyticFlow flow{[](Vec3 x, double) { return Vec3(-x.y, x.x, 0); }, 0.1};
  TraceOptions o;
  o.tolerance = 1e-8;
  TracedLines out;
  const Vec3 seed(1, 0, 0);
  Vec3 v;
  flow(seed, 0, v);
  out.points = {seed}, out.velocity = {v}, out.time = {0}, out.arc = {0};
  CHECK(trace_line(flow, 0, 1, o, out) == StopReason::closed);
  CHECK(out.time.back() == doctest::Approx(2 * pi).epsilon(1e-4));
  CHECK(out.points.back() == seed);
}

TEST_CASE("trace: a line that leaves a box ends at its border") {
  Box3 box;
  box.add({0, 0, 0}), box.add({1, 1, 1});
  AnalyticFlow flow{[](Vec3, double) { return Vec3(1, 0.25, 0); }, 0.1, box};
  TracedLines out;
  const Vec3 seed(0.013, 0.5, 0.5);
  out.points = {seed}, out.velocity = {Vec3(1, 0.25, 0)}, out.time = {0}, out.arc = {0};
  CHECK(trace_line(flow, 0, 1, {}, out) == StopReason::outside);
  CHECK(out.points.back().x == doctest::Approx(1).epsilon(1e-3));
  CHECK(out.arc.back() == doctest::Approx(length(out.points.back() - seed)));
}

TEST_CASE("integrators: the implicit midpoint rule has order 2 and keeps a quadratic stream function for 1000 turns") {
  AnalyticFlow ellipse{[](Vec3 x, double) { return Vec3(-4 * x.y, x.x, 0); }};  // psi = x^2/2 + 2 y^2, a turn takes pi
  const auto psi = [](Vec3 x) { return x.x * x.x / 2 + 2 * x.y * x.y; };
  Vec3 x(1, 0, 0), v;
  const double h = pi / 40;
  for (int n = 0; n < 40000; ++n) {
    ellipse(x, 0, v);
    REQUIRE(fixed_step(Scheme::implicit_midpoint, ellipse, x, 0, h, v, x));
  }
  CHECK(psi(x) == doctest::Approx(0.5).epsilon(1e-10));
  double last = error_of_spiral(Scheme::implicit_midpoint, 16);
  const double now = error_of_spiral(Scheme::implicit_midpoint, 32);
  CHECK(std::log2(last / now) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("integrators: the implicit midpoint rule keeps cells of a nonlinear flow of the plane from drifting where RK4 drifts") {
  // psi = cos x + cos y: closed lines about the origin.
  AnalyticFlow flow{[](Vec3 x, double) { return Vec3(std::sin(x.y), -std::sin(x.x), 0); }};
  const auto psi = [](Vec3 x) { return std::cos(x.x) + std::cos(x.y); };
  for (const Scheme s : {Scheme::implicit_midpoint, Scheme::rk4}) {
    Vec3 x(1.5, 0.2, 0), v;
    double late = 0;
    const double start = psi(x);
    for (int n = 0; n < 20000; ++n) {  // about a thousand turns
      flow(x, 0, v);
      REQUIRE(fixed_step(s, flow, x, 0, 0.45, v, x));
      if (n > 19900) late = std::max(late, std::abs(psi(x) - start));
    }
    if (s == Scheme::implicit_midpoint) CHECK(late < 0.02);
    else CHECK(late > 0.02);
  }
}

TEST_CASE("integrators: the energy of a particle on a spring does not drift in 10000 turns of leapfrog") {
  const auto pull = [](Vec3 x, double) { return -x; };
  Vec3 x(1, 0, 0), v(0, 0.5, 0), a = pull(x, 0);
  const auto energy = [&] { return (dot(v, v) + dot(x, x)) / 2; };
  const double start = energy();
  double worst = 0;
  for (int n = 0; n < 10000 * 32; ++n) {
    symplectic_step(pull, 0, 2 * pi / 32, x, v, a);
    worst = std::max(worst, std::abs(energy() - start));
  }
  CHECK(worst < 0.01 * start);  // swings with h^2, but does not grow
  CHECK(cross(x, v).z == doctest::Approx(0.5).epsilon(1e-10));
}
