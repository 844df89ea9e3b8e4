// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/ftle.h"

#include <algorithm>
#include <cstring>
#include <numbers>

#include "base/parallel.h"
#include "filter/flow/flow_support.h"
#include "support/test.h"

using namespace sg;

namespace {

using std::numbers::pi;

// By steps of Runge-Kutta that leave errors far below those of the differences.
template <class F>
FlowMap map_of(F velocity, double start, double duration) {
  return [=](std::span<const Vec3> from, std::vector<Vec3>& to, std::vector<uint8_t>& known) {
    AnalyticFlow flow{velocity};
    const int n = 4000;
    to.assign(from.begin(), from.end()), known.assign(from.size(), 1);
    for (Vec3& x : to)
      for (int k = 0; k < n; ++k) {
        Vec3 v;
        const double t = start + duration * k / n;
        flow(x, t, v);
        fixed_step(Scheme::rk4, flow, x, t, duration / n, v, x);
      }
  };
}

// Shadden, Lekien, Marsden 2005 with A = 0.1, epsilon = 0.25, period 10.
Vec3 gyre_velocity(Vec3 x, double t) {
  const double e = 0.25 * std::sin(2 * pi / 10 * t);
  const double f = e * x.x * x.x + (1 - 2 * e) * x.x, slope = 2 * e * x.x + 1 - 2 * e;
  return {-pi * 0.1 * std::sin(pi * f) * std::cos(pi * x.y), pi * 0.1 * std::cos(pi * f) * std::sin(pi * x.y) * slope, 0};
}

}  // namespace

TEST_CASE("ftle: of the flow diag(l, -l) it is l everywhere, for any duration and direction, in two and three dimensions") {
  for (const double l : {0.3, 1.7})
    for (const double duration : {0.5, -2.0}) {
      const auto velocity = [=](Vec3 x, double) { return Vec3(l * x.x, -l * x.y, 0); };
      for (const auto& dims : {std::array<size_t, 3>{5, 4, 1}, std::array<size_t, 3>{4, 5, 3}}) {
        Context context;
        const DatasetPtr d = ftle_of(test::even_grid(dims, {-1, -1, -1}, 0.4), duration, {}, map_of(velocity, 0, duration));
        const Field& f = d->fields().require("ftle");
        for (size_t i = 0; i < d->point_count(); ++i) CHECK(f.array.get(i) == doctest::Approx(l).epsilon(1e-5));
        // Forward it pulls along x, backward along y.
        const Field& along = d->fields().require("stretch direction");
        CHECK(std::abs(along.array.get(0, duration > 0 ? 0 : 1)) == doctest::Approx(1));
      }
    }
}

// Variational values by integrating the equation of the deformation gradient (correctness.md F6).
TEST_CASE("ftle: the double gyre has its known values, with order 2 in the spacing of the seeds") {
  const struct {
    Vec3 at;
    double ftle;
  } known[] = {{{0.25, 0.25, 0}, 0.295298}, {{1, 0.5, 0}, 0.0691409}};
  for (const auto& k : known) {
    double error[4], h[4];
    for (int level = 0; level < 4; ++level) {
      h[level] = 2e-3 / (1 << level);
      const UniformGrid g = test::even_grid({3, 3, 1}, k.at - Vec3(h[level], h[level], 0), h[level]);
      const DatasetPtr d = ftle_of(g, 15, {}, map_of(gyre_velocity, 0, 15));
      error[level] = std::abs(d->fields().require("ftle").array.get(4) - k.ftle);
    }
    CAPTURE(k.ftle);
    CHECK(error[3] < 2e-5);
    CHECK(std::log2(error[0] / error[1]) == doctest::Approx(2).epsilon(0.15));
  }
}

TEST_CASE("ftle: places that leave the flow have neighbours on one side only, or no value; threads do not matter") {
  Context context;
  std::vector<double> velocities;
  for (int j = 0; j < 33; ++j)
    for (int i = 0; i < 65; ++i) {
      const Vec3 u = gyre_velocity({i / 32.0, j / 32.0, 0}, 0);
      velocities.insert(velocities.end(), {u.x, u.y});
    }
  FieldSet two;
  two.add({"velocity", Association::point, Array::from_vector(std::move(velocities), 2), "", Role::vectors});
  const DatasetPtr in = make_dataset(Mesh(test::even_grid({65, 33, 1}, {0, 0, 0}, 1 / 32.0)), std::move(two));
  FtleParams p;
  p.duration = 2, p.size = 40;
  set_thread_count(1);
  const DatasetPtr one = ftle(test::steady_series(in), p, context);
  set_thread_count(8);
  const DatasetPtr many = ftle(test::steady_series(in), p, context);
  set_thread_count(0);
  const Array &a = one->fields().require("ftle").array, &b = many->fields().require("ftle").array;
  CHECK(std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
  CHECK(test::error_of([&] {
          FtleParams none;
          none.duration = 0;
          ftle(test::steady_series(in), none, context);
        }).find("duration") != std::string::npos);
  // Uniform wind: whatever reaches the border has left.
  UniformGrid g = test::even_grid({11, 11, 1}, {0, 0, 0}, 0.1);
  FieldSet fields;
  std::vector<float> v;
  for (int i = 0; i < 121; ++i) v.insert(v.end(), {1, 0, 0});
  fields.add({"wind", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
  FtleParams wind;
  wind.duration = 0.5, wind.dims = {11, 11, 1};
  const DatasetPtr d = ftle(test::steady_series(make_dataset(Mesh(g), std::move(fields))), wind, context);
  const Field& f = d->fields().require("ftle");
  CHECK(f.array.get(3) == doctest::Approx(0).epsilon(1e-5));
  CHECK(std::isnan(f.array.get(9)));
}

TEST_CASE("ftle: of a series of grids it approaches the known values of the double gyre") {
  Context context;
  const int n = 201, steps = 121;
  Series series;
  for (int k = 0; k < steps; ++k) series.times.push_back(15.0 * k / (steps - 1));
  series.load = [&](size_t k) -> Data {
    std::vector<float> v;
    for (int j = 0; j < (n + 1) / 2; ++j)
      for (int i = 0; i < n; ++i) {
        const Vec3 u = gyre_velocity({2.0 * i / (n - 1), 2.0 * j / (n - 1), 0}, series.times[k]);
        v.insert(v.end(), {float(u.x), float(u.y), 0.0f});
      }
    FieldSet fields;
    fields.add({"velocity", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
    return make_dataset(Mesh(test::even_grid({size_t(n), size_t(n + 1) / 2, 1}, {0, 0, 0}, 2.0 / (n - 1))), std::move(fields));
  };
  const struct {
    Vec3 at;
    double ftle;
  } known[] = {{{0.25, 0.25, 0}, 0.295298}, {{1, 0.5, 0}, 0.0691409}};
  for (const auto& k : known) {
    FtleParams p;
    p.duration = 15, p.interpolation = TimeInterpolation::cubic, p.offset = 5e-4, p.dims = {3, 3, 1};
    p.bounds = {k.at.x - 0.01, k.at.x + 0.01, k.at.y - 0.01, k.at.y + 0.01, 0, 0};
    const DatasetPtr d = ftle(series, p, context);
    CHECK(d->fields().require("ftle").array.get(4) == doctest::Approx(k.ftle).epsilon(0.01));
  }
  FtleParams late;
  late.duration = 10, late.start = 8;
  CHECK(test::error_of([&] { ftle(series, late, context); }).find("from 8 to 18") != std::string::npos);
}

TEST_CASE("ftle: without a duration the mean speed goes a tenth of the diagonal, and solid meshes get 64 seeds along an axis") {
  Context context;
  UniformGrid g = test::even_grid({11, 6, 6}, {0, 0, 0}, 1);
  FieldSet fields;
  std::vector<float> v;
  for (int i = 0; i < 11 * 6 * 6; ++i) v.insert(v.end(), {0, 2, 0});
  fields.add({"wind", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
  const DatasetPtr d = ftle(test::steady_series(make_dataset(Mesh(g), std::move(fields))), {}, context);
  const UniformGrid& seeds = *d->as<UniformGrid>();
  CHECK(seeds.dims[0] == 64);
  const Array& went = d->fields().require("flow map").array;
  const double way = 0.1 * std::sqrt(100.0 + 25 + 25);  // a uniform flow of speed 2 goes as far in way / 2
  CHECK(went.get(0, 1) == doctest::Approx(way).epsilon(1e-4));
  CHECK(went.get(0, 0) == doctest::Approx(0));
}

TEST_CASE("ftle: steps as long as the tolerance lets them be give the values of short ones") {
  const int n = 201, steps = 41;
  Series series;
  for (int k = 0; k < steps; ++k) series.times.push_back(10.0 * k / (steps - 1));
  series.load = [&](size_t k) -> Data {
    std::vector<float> v;
    for (int j = 0; j < (n + 1) / 2; ++j)
      for (int i = 0; i < n; ++i) {
        const Vec3 u = gyre_velocity({2.0 * i / (n - 1), 2.0 * j / (n - 1), 0}, series.times[k]);
        v.insert(v.end(), {float(u.x), float(u.y)});
      }
    FieldSet fields;
    fields.add({"velocity", Association::point, Array::from_vector(std::move(v), 2), "", Role::vectors});
    return make_dataset(Mesh(test::even_grid({size_t(n), size_t(n + 1) / 2, 1}, {0, 0, 0}, 2.0 / (n - 1))), std::move(fields));
  };
  Context context;
  FtleParams p;
  p.duration = 10, p.dims = {128, 64, 1};
  const DatasetPtr d = ftle(series, p, context);
  p.integration.max_step = 0.1, p.integration.tolerance = 1e-7;
  const DatasetPtr exact = ftle(series, p, context);
  const Array &a = d->fields().require("ftle").array, &b = exact->fields().require("ftle").array;
  double worst = 0, sum = 0;
  for (size_t i = 0; i < a.count(); ++i) {
    REQUIRE(std::isfinite(a.get(i)));
    const double e = std::abs(a.get(i) - b.get(i));
    worst = std::max(worst, e), sum += e;
  }
  CHECK(worst < 1e-3);
  CHECK(sum / double(a.count()) < 2e-5);
}

TEST_CASE("ftle: how many particles leave is told, and none when all stay") {
  std::string log;
  Context context;
  context.on_log = [&](LogLevel, std::string_view text) { log += text; };
  FtleParams p;
  p.duration = 0.5, p.size = 9;
  const DatasetPtr wind =
      ftle(test::steady_series(test::cube_flow(9, -1, 1, [](Vec3) { return Vec3(0.9, 0, 0); })), p, context);  // two of nine columns leave
  CHECK(log.find("22.2 % of the particles") != std::string::npos);
  CHECK(std::isnan(wind->fields().require("ftle").array.get(8)));
  log.clear();
  const DatasetPtr still =
      ftle(test::steady_series(test::cube_flow(9, -1, 1, [](Vec3 x) { return Vec3(x.x * (1 - x.x * x.x), 0, 0) * 0.1; })), p, context);
  CHECK(still->stats(still->fields().require("ftle")).nan == 0);
  CHECK(log.find("particles") == std::string::npos);
}

TEST_CASE("ftle: steps so small that no particle would arrive are refused at once, with how large they must be") {
  Context context;
  UniformGrid g = test::even_grid({11, 6, 6}, {0, 0, 0}, 1);
  FieldSet fields;
  std::vector<float> v;
  for (int i = 0; i < 11 * 6 * 6; ++i) v.insert(v.end(), {0, 2, 0});
  fields.add({"wind", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
  const auto series = test::steady_series(make_dataset(Mesh(g), std::move(fields)));
  FtleParams p;
  p.duration = 2;  // a way of 4 cells
  for (const auto& [unit, step] : {std::pair(StepUnit::cells, 1e-6), {StepUnit::length, 1e-6}, {StepUnit::time, 1e-6}}) {
    p.integration.integrator = Scheme::rk4, p.integration.step = step, p.integration.step_unit = unit;
    CAPTURE(int(unit));
    CHECK_THROWS_WITH_AS(ftle(series, p, context), doctest::Contains("use steps"), Error);
  }
  p.integration.step = 1e-3, p.integration.step_unit = StepUnit::cells, p.size = 4;
  CHECK(ftle(series, p, context)->point_count() > 0);
}
