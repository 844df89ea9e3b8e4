// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/integrator.h"

#include "base/context.h"
#include "filter/flow/flow_field.h"
#include "filter/flow/trace.h"
#include "filter/flow/trace_line.h"
#include "support/test.h"

using namespace sg;

namespace {

constexpr double pi = 3.14159265358979323846;

// A flow whose velocity depends on place and time and whose path is known: a spiral around the z axis whose pitch is driven by cos t,
// x = e^{-t/10} (cos t, sin t), z = sin t.
Vec3 spiral_velocity(Vec3 x, double t) { return {-0.1 * x.x - x.y, x.x - 0.1 * x.y, std::cos(t)}; }
Vec3 spiral(double t) { return {std::exp(-t / 10) * std::cos(t), std::exp(-t / 10) * std::sin(t), std::sin(t)}; }

double error_of(Scheme scheme, int steps) {
  AnalyticFlow flow{spiral_velocity};
  const double h = 2.0 / steps;
  Vec3 x = spiral(0), v;
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
  return length(x - spiral(2));
}

}  // namespace

TEST_CASE("integrators: errors of a known unsteady path fall with the order of each scheme") {
  for (const Scheme s : {Scheme::euler, Scheme::midpoint, Scheme::heun, Scheme::rk4, Scheme::dormand_prince}) {
    const int n = s == Scheme::dormand_prince ? 8 : 16;
    double last = error_of(s, n);
    for (int k = 1; k <= 3; ++k) {
      const double now = error_of(s, n << k), order = std::log2(last / now);
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
    flow(spiral(0.3), 0.3, v);
    REQUIRE(dormand_prince_step(flow, spiral(0.3), 0.3, h, v, s));
    double worst = 0;
    for (const double theta : {0.25, 0.5, 0.8}) worst = std::max(worst, length(s.at(theta) - spiral(0.3 + theta * h)));
    CHECK(length(s.at(0) - spiral(0.3)) < 1e-14);
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
