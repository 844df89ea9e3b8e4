// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/unsteady/unsteady_lines.h"

#include "base/parallel.h"
#include "filter/flow/unsteady/advance_one.h"
#include "filter/flow/unsteady/pathlines.h"
#include "filter/flow/unsteady/streaklines.h"
#include "filter/flow/unsteady/timelines.h"
#include "filter/mesh/to_unstructured.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test::unsteady;
using test::even_times;
using test::grid;
using test::series_of;

TEST_CASE("unsteady: RK4 follows the oscillating flow with order 4, the other schemes with theirs") {
  for (const Scheme scheme : {Scheme::euler, Scheme::midpoint, Scheme::heun, Scheme::rk4}) {
    double h[4], error[4];
    for (int i = 0; i < 4; ++i) {
      // A shear beside the oscillation, so that places matter as well: y' = V cos wt + x, x = x0 + U t.
      AnalyticFlow flow{[](Vec3 x, double t) { return oscillating(x, t) + Vec3(0, x.x, 0); }};
      TraceOptions o;
      o.scheme = scheme, o.unit = StepUnit::time, o.step = h[i] = 0.25 / double(1 << i);
      Particle p;
      p.x = {0.1, 0.2, 0};
      REQUIRE(detail::start_particle(flow, p));
      detail::advance_one(flow, p, 2.0, o, [](const Particle&) {});
      CHECK(p.t == 2.0);
      error[i] = length(p.x - went({0.1, 0.2, 0}, 0, 2) - Vec3(0, 0.1 * 2 + U * 2, 0));
    }
    const double order = test::observed_order(h, error, 4);
    CHECK(std::abs(order - order_of(scheme)) < 0.2);
  }
}

TEST_CASE("unsteady: Dormand-Prince keeps its tolerance, forwards and backwards") {
  AnalyticFlow flow{oscillating};
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    TraceOptions o;
    o.tolerance = tolerance, o.min_step = 1e-6;
    Particle p;
    p.x = {0.1, 0.2, 0};
    detail::start_particle(flow, p);
    detail::advance_one(flow, p, 5.0, o, [](const Particle&) {});
    CHECK(length(p.x - went({0.1, 0.2, 0}, 0, 5)) < 20 * tolerance);
    detail::advance_one(flow, p, 0.0, o, [](const Particle&) {});
    CHECK(p.t == 0);
    CHECK(length(p.x - Vec3(0.1, 0.2, 0)) < 40 * tolerance);
  }
}

TEST_CASE("pathlines: the oscillating flow has its closed form; linear in time order 2, cubic more") {
  for (const char* how : {"linear", "cubic"}) {
    double h[3], error[3];
    for (int i = 0; i < 3; ++i) {
      const size_t n = size_t(10) << i;
      h[i] = 1.0 / double(n);
      Context context;
      auto p = seeded_at<PathlinesParams>({-1, 0, 0, -0.5, 0.3, 0.2});
      p.interpolation = *value_of_word<TimeInterpolation>(how), p.integration.tolerance = 1e-9;
      const Lines lines{pathlines(oscillating_series(n + 1), {}, p, context)};
      REQUIRE(lines.mesh().lines.size() == 2);
      error[i] = 0;
      for (size_t k = 0; k < lines.points(); ++k) {
        const bool first = k < lines.mesh().lines.offsets.get(1);
        const Vec3 truth = went(first ? Vec3(-1, 0, 0) : Vec3(-0.5, 0.3, 0.2), 0, lines.value("time", k));
        error[i] = std::max(error[i], length(lines.x(k) - truth));
      }
    }
    const double order = test::observed_order(h, error, 3);
    if (std::string(how) == "linear") CHECK(order == doctest::Approx(2).epsilon(0.1));
    else CHECK(order > 2.8);
    CHECK(error[2] < 2e-3);
  }
}

TEST_CASE("pathlines: backwards from the end they come to the seeds, and carry what the mesh has") {
  Context context;
  auto p = seeded_at<PathlinesParams>({-1, 0, 0.5});
  p.interpolation = TimeInterpolation::cubic, p.start = 0.25, p.time = 1.75, p.integration.tolerance = 1e-8;
  const Lines forward{pathlines(oscillating_series(41), {}, p, context)};
  const Vec3 end = forward.x(forward.points() - 1);
  CHECK(forward.value("time", 0) == 0.25);
  CHECK(forward.value("time", forward.points() - 1) == 1.75);
  CHECK(forward.value("length", 0) == 0);
  CHECK(forward.data->time() == 1.75);
  for (size_t k = 0; k < forward.points(); ++k)
    CHECK(forward.value("height", k) == doctest::Approx(forward.x(k).z + forward.x(k).x).epsilon(1e-5));
  p.seeds.points = {end.x, end.y, end.z};
  p.start = 1.75, p.time = 0.25;
  const Lines back{pathlines(oscillating_series(41), {}, p, context)};
  CHECK(length(back.x(back.points() - 1) - Vec3(-1, 0, 0.5)) < 1e-5);
  CHECK(back.value("time", back.points() - 1) == 0.25);
}

TEST_CASE("unsteady: in a steady flow path-, streak- and streamlines are one") {
  const auto steady = [](Vec3 x, double) { return Vec3(-x.y, x.x, 0.1); };
  const auto fine = [](double) -> Mesh { return grid(41, {-2, -2, -2}, {2, 2, 2}); };
  const Series series = series_of(even_times(0, 3, 61), fine, steady);
  Context context;
  auto path = seeded_at<PathlinesParams>({1, 0, 0});
  path.integration.tolerance = 1e-8;
  auto streak = seeded_at<StreaklinesParams>({1, 0, 0});
  streak.integration.tolerance = 1e-8;
  const Lines a{pathlines(series, {}, path, context)}, b{streaklines(series, {}, streak, context)};
  for (size_t k = 0; k < a.points(); ++k) {
    const double t = a.value("time", k);
    CHECK(length(a.x(k) - Vec3(std::cos(t), std::sin(t), 0.1 * t)) < 1e-5);
  }
  for (size_t k = 0; k < b.points(); ++k) {
    const double t = b.value("age", k);
    CHECK(length(b.x(k) - Vec3(std::cos(t), std::sin(t), 0.1 * t)) < 1e-5);
  }
}

TEST_CASE("unsteady: the double gyre's particles go where its formula sends them") {
  Context context;
  const Series series = gyre_series(100, even_times(0, 5, 101));
  auto p = seeded_at<PathlinesParams>({0.4, 0.3, 0, 1.5, 0.7, 0, 0.95, 0.5, 0});
  p.interpolation = TimeInterpolation::cubic, p.integration.tolerance = 1e-7;
  const Lines lines{pathlines(series, {}, p, context)};
  for (size_t l = 0; l < 3; ++l) {
    AnalyticFlow flow{gyre};
    TraceOptions o;
    o.scheme = Scheme::rk4, o.unit = StepUnit::time, o.step = 0.01;
    Particle q;
    q.x = {p.seeds.points[3 * l], p.seeds.points[3 * l + 1], 0};
    detail::start_particle(flow, q);
    detail::advance_one(flow, q, 5, o, [](const Particle&) {});
    const size_t last = size_t(lines.mesh().lines.offsets.get(l + 1)) - 1;
    CHECK(length(lines.x(last) - q.x) < 1e-3);
  }
}

TEST_CASE("unsteady: a particle stays in the moving mesh that carries it") {
  // A piston: the mesh shrinks towards x = 1, the gas moves with it.
  const auto left = [](double t) { return 0.6 * t; };
  const auto mesh = [&](double t) -> Mesh { return grid(6, {left(t), 0, 0}, {1, 1, 1}); };
  const auto v = [&](Vec3 x, double t) { return Vec3(0.6 * (1 - x.x) / (1 - left(t)), 0, 0); };
  for (const bool cells : {false, true}) {
    const auto kind = [&](double t) -> Mesh {
      return cells ? to_unstructured(test::with_velocity(mesh(t), [](Vec3) { return Vec3(); }))->mesh() : mesh(t);
    };
    Context context;
    auto p = seeded_at<PathlinesParams>({0.01, 0.5, 0.5, 0.5, 0.2, 0.9});
    p.integration.tolerance = 1e-7;
    const Lines lines{pathlines(series_of(even_times(0, 1, 5), kind, v), {}, p, context)};
    REQUIRE(lines.mesh().lines.size() == 2);
    for (size_t k = 0; k < lines.points(); ++k) {
      const bool first = k < lines.mesh().lines.offsets.get(1);
      const double x0 = first ? 0.01 : 0.5, t = lines.value("time", k);
      CHECK(std::abs(lines.x(k).x - (1 - (1 - x0) * (1 - left(t)))) < 1e-4);
    }
    CHECK(lines.value("time", lines.points() - 1) == 1);
  }
}

TEST_CASE("unsteady: where the mesh is another one at each step, particles go on") {
  const auto mesh = [](double t) -> Mesh { return grid(5 + size_t(t * 8), {-2, -2, -2}, {2, 2, 2}); };
  Context context;
  const Lines lines{pathlines(series_of(even_times(0, 1, 5), mesh, oscillating), {}, seeded_at<PathlinesParams>({-1, 0, 0}), context)};
  const size_t last = lines.points() - 1;
  CHECK(lines.value("time", last) == 1);
  CHECK(length(lines.x(last) - went({-1, 0, 0}, 0, 1)) < 2e-2);  // linear over a quarter
}

TEST_CASE("unsteady: any number of threads gives the same bytes") {
  Context context;
  const Series series = gyre_series(32, even_times(0, 3, 13));
  const auto all = [&](int threads) {
    set_thread_count(threads);
    PathlinesParams path;
    path.seeds.count = 700;
    StreaklinesParams streak;
    streak.seeds.count = 300;
    TimelinesParams time;
    time.seeds.from = Vec3(0.1, 0.4, 0), time.seeds.to = Vec3(1.9, 0.6, 0), time.seeds.count = 400;
    ParticlesParams cloud;
    cloud.seeds.count = 300, cloud.every = 0.1;
    std::vector<DatasetPtr> out{pathlines(series, {}, path, context), streaklines(series, {}, streak, context),
                                timelines(series, {}, time, context), particles(series, {}, cloud, context)};
    set_thread_count(0);
    return out;
  };
  const auto one = all(1), eight = all(8);
  for (size_t i = 0; i < one.size(); ++i) check_same_bytes(*one[i], *eight[i]);
}

TEST_CASE("unsteady: a particle at rest waits until the flow wakes up") {
  const auto v = [](Vec3, double t) { return t < 0.5 ? Vec3() : Vec3(t - 0.5, 0, 0); };
  Context context;
  const Lines lines{pathlines(series_of({0, 0.25, 0.5, 1}, big_box, v), {}, seeded_at<PathlinesParams>({-1, 0, 0}), context)};
  CHECK(length(lines.x(lines.points() - 1) - Vec3(-0.875, 0, 0)) < 1e-6);
  CHECK(lines.data->fields().require("stop", Association::cell).array.get(0) == int(StopReason::time));
}

TEST_CASE("unsteady: particles that leave end at the border, those in NaN do not begin") {
  const auto v = [](Vec3 x, double t) { return x.y > 1.2 ? Vec3(NAN, 0, 0) : Vec3(1, 0.1 * t, 0); };
  Context context;
  const Lines lines{
      pathlines(series_of(even_times(0, 2, 5), big_box, v), {}, seeded_at<PathlinesParams>({1, 0, 0, 0, 1.9, 0, 9, 9, 9}), context)};
  REQUIRE(lines.mesh().lines.size() == 1);
  CHECK(std::abs(lines.x(lines.points() - 1).x - 2) < 0.01);
  CHECK(lines.data->fields().require("stop", Association::cell).array.get(0) == int(StopReason::outside));
  const std::string none = test::error_of([&] {
    pathlines(series_of({0, 1}, big_box, v), {}, seeded_at<PathlinesParams>({9, 9, 9}), context);
  });
  CHECK(none.find("none of 1 seeds lies in the flow; the mesh extends over x -2 to 2") != std::string::npos);
}

TEST_CASE("unsteady: bad requests say what is wrong") {
  Context context;
  const auto message = [&](auto p, const Series& series) {
    return test::error_of([&] {
      if constexpr (std::is_same_v<decltype(p), PathlinesParams>) pathlines(series, {}, p, context);
      else if constexpr (std::is_same_v<decltype(p), StreaklinesParams>) streaklines(series, {}, p, context);
      else timelines(series, {}, p, context);
    });
  };
  auto path = seeded_at<PathlinesParams>({0, 0, 0});
  CHECK(message(path, oscillating_series(1)).find("streamlines") != std::string::npos);
  path.start = 5;
  CHECK(message(path, oscillating_series(3)).find("start=5 lies outside the series; the series runs from 0 to 2") != std::string::npos);
  auto streak = seeded_at<StreaklinesParams>({0, 0, 0});
  streak.start = 1, streak.time = 0.5;
  CHECK(message(streak, oscillating_series(3)).find("use pathlines to go backwards") != std::string::npos);
  streak = seeded_at<StreaklinesParams>({0, 0, 0});
  streak.every = 1e-12;
  CHECK(message(streak, oscillating_series(3)).find("releases") != std::string::npos);
  TimelinesParams time;
  time.seeds.points = {0, 0, 0};
  CHECK(message(time, oscillating_series(3)).find("does not make a line") != std::string::npos);
  CHECK(message(TimelinesParams{}, oscillating_series(3)).find("random seeds do not make a line") != std::string::npos);
}

TEST_CASE("unsteady: 1,000 steps, two in memory") {
  auto watched = std::make_shared<test::Watched>();
  Context context;
  const Series series = series_of(even_times(0, 2, 1000), big_box, oscillating, true, watched);
  const Lines lines{streaklines(series, {}, seeded_at<StreaklinesParams>({-1, 0, 0}), context)};
  CHECK(lines.points() == 1000);
  CHECK(watched->loads == 1000);
  CHECK(watched->most == 2);
  CHECK(length(lines.x(999) - went({-1, 0, 0}, 0, 2)) < 1e-5);
}

TEST_CASE("unsteady: uniform f32 grids take the fast way, with the answer of the general one") {
  const auto swirl = [](Vec3 x, double t) {
    return Vec3(std::sin(2 * x.y + t), std::cos(1.5 * x.z - t), std::sin(x.x) * (1 + 0.3 * t)) * 1.5;
  };
  for (const char* how : {"linear", "cubic"})
    for (const int kind : {0, 1, 2}) {
      const bool flat = kind == 1;
      const auto box = [&](double) -> Mesh { return flat ? grid(33, {-2, -2, 0.5}, {2, 2, 0.5}, 1) : grid(33, {-2, -2, -2}, {2, 2, 2}); };
      const auto v = [&](Vec3 x, double t) { return swirl(x, t) * Vec3(1, 1, flat ? 0 : 1); };
      const auto f32 = series_of(even_times(0, 1.5, 7), box, v, true);
      Series f64 = f32;  // the same numbers, which only the general way takes
      f64.load = [&](size_t k) -> Data {
        const DatasetPtr d = std::get<DatasetPtr>(f32.load(k));
        DatasetParts parts = d->parts();
        Field u = parts.fields.require("velocity");
        u.array = u.array.converted(ElementType::f64);
        parts.fields.add(u);
        return make_dataset(std::move(parts));
      };
      Context context;
      PathlinesParams p;
      p.interpolation = *value_of_word<TimeInterpolation>(how);
      if (kind == 2) p.integration.integrator = Scheme::rk4;
      else p.integration.tolerance = 1e-6;
      p.seeds.seeds = SeedKind::grid, p.seeds.counts = {9, 9, flat ? 1 : 5};
      const Lines a{pathlines(f32, {}, p, context)}, b{pathlines(f64, {}, p, context)};
      REQUIRE(a.mesh().lines.size() == b.mesh().lines.size());
      size_t same_points = 0, ends = 0;
      double worst = 0;
      for (size_t l = 0; l < a.mesh().lines.size(); ++l) {
        const size_t i = size_t(a.mesh().lines.offsets.get(l + 1)) - 1, k = size_t(b.mesh().lines.offsets.get(l + 1)) - 1;
        same_points += i == k;
        const double when = a.value("time", i);
        if (when == 1.5 && b.value("time", k) == 1.5) worst = std::max(worst, length(a.x(i) - b.x(k))), ++ends;
        else CHECK(std::abs(when - b.value("time", k)) < 0.01);
      }
      CHECK(ends > 20);
      CHECK(worst < (kind == 2 ? 1e-5 : 3e-4));  // sizes of adaptive steps differ a little, and the field has kinks
      PathlinesParams back = p;
      back.start = 1.5, back.time = 0;
      const Lines c{pathlines(f32, {}, back, context)}, d{pathlines(f64, {}, back, context)};
      CHECK(c.mesh().lines.size() == d.mesh().lines.size());
      CHECK(std::abs(double(c.points()) - double(d.points())) < (kind == 2 ? 0.01 : 0.15) * double(d.points()));
    }
}

TEST_CASE("unsteady: on a flat mesh of cells particles leave over the border, and seeds beside it do not begin") {
  const auto flat = [](double) -> Mesh {
    return to_unstructured(test::with_velocity(grid(9, {-2, -2, 0}, {2, 2, 0}, 1), [](Vec3) { return Vec3(); }))->mesh();
  };
  const auto v = [](Vec3, double t) { return Vec3(1, 0.2 * t, 0); };
  Context context;
  const Lines lines{pathlines(series_of(even_times(0, 4, 5), flat, v), {}, seeded_at<PathlinesParams>({0, 0, 0, 5, 0, 0}), context)};
  REQUIRE(lines.mesh().lines.size() == 1);
  CHECK(std::abs(lines.x(lines.points() - 1).x - 2) < 0.02);
  CHECK(lines.value("time", lines.points() - 1) < 2.1);
  CHECK(lines.data->fields().require("stop", Association::cell).array.get(0) == int(StopReason::outside));
}
