// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/unsteady/unsteady_flow.h"

#include "base/parallel.h"
#include "filter/flow/unsteady/unsteady_inputs.h"
#include "filter/mesh/to_unstructured.h"
#include "support/test.h"

using namespace sg;
using test::even_times;
using test::grid;
using test::series_of;

namespace {

const auto box = [](double) -> Mesh { return grid(5, {0, 0, 0}, {1, 1, 1}); };
// Linear in space, so that interpolation is exact there.
const auto wave = [](Vec3 x, double t) { return Vec3(std::sin(t) + x.y, t * t * t - x.x, 1 + t * x.z); };

double error_of_interpolation(TimeInterpolation how, size_t steps) {
  Context context;
  UnsteadyFlow flow(series_of(even_times(0, 2, steps), box, wave), "velocity", how, context);
  double worst = 0;
  for (size_t k = 0; k < flow.intervals(); ++k) {
    flow.open(k, context);
    UnsteadyCursor cursor(flow);
    for (const double s : {0.0, 0.25, 0.5, 0.9, 1.0}) {
      const double t = flow.begin() + s * (flow.end() - flow.begin());
      Vec3 v;
      REQUIRE(cursor({0.3, 0.6, 0.7}, t, v));
      worst = std::max(worst, length(v - wave({0.3, 0.6, 0.7}, t)));
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("unsteady flow: linear in time has order 2, cubic order 3") {
  double h[3], linear[3], cubic[3];
  for (int i = 0; i < 3; ++i) {
    const size_t n = size_t(8) << i;
    h[i] = 2.0 / double(n);
    linear[i] = error_of_interpolation(TimeInterpolation::linear, n + 1);
    cubic[i] = error_of_interpolation(TimeInterpolation::cubic, n + 1);
  }
  CHECK(test::observed_order(h, linear, 3) == doctest::Approx(2).epsilon(0.05));
  CHECK(test::observed_order(h, cubic, 3) > 2.8);
}

TEST_CASE("unsteady flow: parabolas in time are exact with cubic interpolation on uneven times") {
  const auto v = [](Vec3 x, double t) { return Vec3(t * t, x.x * (1 - 2 * t * t), 3 - t); };
  Context context;
  UnsteadyFlow flow(series_of({0, 0.1, 1, 1.25, 3}, box, v), "", TimeInterpolation::cubic, context);
  for (size_t k = 0; k < 4; ++k) {
    flow.open(k, context);
    UnsteadyCursor cursor(flow);
    for (const double s : {0.0, 0.3, 0.5, 1.0}) {
      const double t = flow.begin() + s * (flow.end() - flow.begin());
      Vec3 u;
      REQUIRE(cursor({0.5, 0.25, 0.125}, t, u));
      CHECK(length(u - v({0.5, 0.25, 0.125}, t)) < 1e-12);
    }
  }
}

TEST_CASE("unsteady flow: two steps are in memory for linear, four for cubic, and each is loaded once") {
  for (const auto how : {TimeInterpolation::linear, TimeInterpolation::cubic}) {
    auto watched = std::make_shared<test::Watched>();
    Context context;
    UnsteadyFlow flow(series_of(even_times(0, 1, 1000), box, wave, true, watched), "", how, context);
    for (size_t k = 0; k < flow.intervals(); ++k) flow.open(k, context);
    CHECK(watched->loads == 1000);
    CHECK(watched->most == (how == TimeInterpolation::linear ? 2 : 4));
  }
}

TEST_CASE("unsteady flow: one mesh has one locator, a changed one a new one") {
  Context context;
  UnsteadyFlow flow(series_of(
                        {0, 1, 2},
                        [](double t) -> Mesh {
                          return grid(t < 2 ? 5 : 7, {0, 0, 0}, {1, 1, 1});
                        },
                        wave),
                    "", TimeInterpolation::linear, context);
  flow.open(0, context);
  CHECK(flow.meshes() == UnsteadyFlow::Meshes::same);
  CHECK(flow.steps()[0].locator() == flow.steps()[1].locator());
  flow.open(1, context);
  CHECK(flow.meshes() == UnsteadyFlow::Meshes::changed);
  UnsteadyCursor cursor(flow);
  Vec3 v, a = wave({0.3, 0.4, 0.5}, 1), b = wave({0.3, 0.4, 0.5}, 2);
  REQUIRE(cursor({0.3, 0.4, 0.5}, 1.25, v));
  CHECK(length(v - (a * 0.75 + b * 0.25)) < 1e-12);
  CHECK(!cursor({1.3, 0.4, 0.5}, 1.25, v));
}

TEST_CASE("unsteady flow: where the meshes change, the one nearest in time says what is inside") {
  Context context;
  UnsteadyFlow flow(series_of(
                        {0, 1},
                        [](double t) -> Mesh {
                          return grid(t < 1 ? 5 : 9, {0, 0, 0}, {1 + t, 1, 1});
                        },
                        wave),
                    "", TimeInterpolation::linear, context);
  flow.open(0, context);
  UnsteadyCursor cursor(flow);
  Vec3 v;
  CHECK(!cursor({1.5, 0.5, 0.5}, 0.25, v));
  REQUIRE(cursor({1.5, 0.5, 0.5}, 0.75, v));
  CHECK(length(v - wave({1.5, 0.5, 0.5}, 1)) < 1e-12);  // of the step that has it
}

TEST_CASE("unsteady flow: on a moving mesh places follow the points, on every kind that can move") {
  // Points x(t) = x0 (1 + t/2) + (t, 0, 0): a place fixed in the mesh moves along, and the velocity at the points depends on x0.
  const auto at = [](Vec3 x0, double t) { return x0 * (1 + t / 2) + Vec3(t, 0, 0); };
  const auto inverse = [](Vec3 x, double t) { return (x - Vec3(t, 0, 0)) / (1 + t / 2); };
  const auto v = [&](Vec3 x, double t) { return inverse(x, t) * (1 + t) + Vec3(0.5, 1 - t, 0); };
  const auto uniform = [&](double t) -> Mesh { return grid(5, at({0, 0, 0}, t), at({1, 1, 1}, t)); };
  const auto cells = [&](double t) -> Mesh {
    Context context;
    return to_unstructured(test::with_velocity(uniform(t), [](Vec3) { return Vec3(); }), {}, context)->mesh();
  };
  for (const auto& mesh : {std::function<Mesh(double)>(uniform), std::function<Mesh(double)>(cells)}) {
    Context context;
    UnsteadyFlow flow(series_of({0, 1}, mesh, v), "velocity", TimeInterpolation::linear, context);
    flow.open(0, context);
    CHECK(flow.meshes() == UnsteadyFlow::Meshes::moving);
    UnsteadyCursor cursor(flow);
    for (const Vec3 x0 : {Vec3(0.1, 0.2, 0.3), Vec3(0.9, 0.99, 0.01), Vec3(0, 0, 0), Vec3(1, 1, 1)})
      for (const double t : {0.0, 0.3, 0.7, 1.0}) {
        Vec3 u;
        REQUIRE(cursor(at(x0, t), t, u));
        CHECK(length(u - v(at(x0, t), t)) < 1e-7);
        CHECK(!cursor(at(x0 + Vec3(1.2, 0, 0), t), t, u));
      }
  }
}

TEST_CASE("unsteady flow: times outside the interval, NaN and places outside have no velocity") {
  const auto hole = [](Vec3 x, double t) { return x.x > 0.7 && t > 0.5 ? Vec3(NAN, 0, 0) : Vec3(1, 0, 0); };
  Context context;
  UnsteadyFlow flow(series_of({0, 1}, box, hole), "velocity", TimeInterpolation::linear, context);
  flow.open(0, context);
  UnsteadyCursor cursor(flow);
  Vec3 v;
  CHECK(cursor({0.9, 0.5, 0.5}, 0, v));
  CHECK(!cursor({0.9, 0.5, 0.5}, 0.5, v));
  CHECK(cursor({0.4, 0.5, 0.5}, 0.5, v));
  CHECK(!cursor({0.4, 0.5, 0.5}, 1.5, v));
  CHECK(!cursor({0.4, 0.5, 0.5}, -0.5, v));
  CHECK(!cursor({0.4, 0.5, 1.5}, 0.5, v));
  CHECK(!cursor({NAN, 0.5, 0.5}, 0.5, v));
}

TEST_CASE("unsteady flow: other fields at the last place and time") {
  Context context;
  UnsteadyFlow flow(series_of({0, 1}, box, wave), "velocity", TimeInterpolation::linear, context);
  flow.open(0, context);
  UnsteadyCursor cursor(flow);
  Vec3 v;
  REQUIRE(cursor({0.25, 0.5, 0.7}, 0.3, v));
  std::vector<Array> height;
  for (const FlowField& s : flow.steps()) height.push_back(s.dataset()->fields().require("height").array);
  CHECK(cursor.value(height, Association::point, 0) == doctest::Approx(0.95));
  height[1] = {};
  CHECK(std::isnan(cursor.value(height, Association::point, 0)));
}

TEST_CASE("unsteady flow: bad series are refused with their reason") {
  Context context;
  const auto make = [&](std::vector<double> times) {
    return test::error_of([&] { UnsteadyFlow(series_of(times, box, wave), "", TimeInterpolation::linear, context); });
  };
  CHECK(make({3}).find("1 time step; at least two are needed; streamlines") != std::string::npos);
  CHECK(make({0, 2, 1}).find("step 1 has 2, step 2 has 1") != std::string::npos);
  CHECK(make({0, 2, 2}).find("do not increase") != std::string::npos);
  CHECK(make({0, NAN}).find("step 1") != std::string::npos);
  UnsteadyFlow flow(series_of({0, 1}, box, wave), "speed", TimeInterpolation::linear, context);
  const std::string text = test::error_of([&] { flow.open(0, context); });
  CHECK(text.find("loading time step 0 (time 0)") != std::string::npos);
  UnsteadyFlow scalar(series_of({0, 1}, box, wave), "height", TimeInterpolation::linear, context);
  CHECK(test::error_of([&] { scalar.open(0, context); }).find("1 component") != std::string::npos);
}

TEST_CASE("unsteady flow: the interval that a time and a direction mean") {
  Context context;
  const UnsteadyFlow flow(series_of({0, 1, 3}, box, wave), "", TimeInterpolation::linear, context);
  CHECK(flow.interval_of(0, 1) == 0);
  CHECK(flow.interval_of(1, 1) == 1);
  CHECK(flow.interval_of(1, -1) == 0);
  CHECK(flow.interval_of(0.5, -1) == 0);
  CHECK(flow.interval_of(3, 1) == 1);
  CHECK(flow.interval_of(3, -1) == 1);
  CHECK(flow.interval_of(0, -1) == 0);
  CHECK(!flow.covers(3.5));
}
