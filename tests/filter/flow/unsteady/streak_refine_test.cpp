// SPDX-License-Identifier: Apache-2.0
#include "base/parallel.h"
#include "filter/flow/unsteady/pathlines.h"
#include "filter/flow/unsteady/streaklines.h"
#include "filter/flow/unsteady/unsteady_lines.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test::unsteady;
using test::even_times;
using test::grid;
using test::series_of;

TEST_CASE("streaklines: releases between the steps keep the closed form of the oscillating flow") {
  Context context;
  auto p = seeded_at<StreaklinesParams>({-1.5, 0, 0});
  p.interpolation = TimeInterpolation::cubic, p.integration.tolerance = 1e-8, p.spacing = 0.02;
  const Lines lines{streaklines(oscillating_series(41), {}, p, context)};
  CHECK(lines.mesh().lines.size() == 1);
  CHECK(lines.points() > 41 * 2);
  double longest = 0, worst = 0;
  for (size_t i = 0; i < lines.points(); ++i) {
    const double born = 2 - lines.value("age", i);
    worst = std::max(worst, length(lines.x(i) - went({-1.5, 0, 0}, born, 2)));
    if (i > 0) longest = std::max(longest, length(lines.x(i) - lines.x(i - 1)));
    if (i > 0) CHECK(lines.value("age", i) > lines.value("age", i - 1));
  }
  CHECK(worst < 2e-5);
  CHECK(longest <= 0.02 * 1.000001);
}

TEST_CASE("streaklines: particles that come between are where their release time says") {
  // Stretching: v = (x + 1.5, 0) doubles distances in 0.7, with a swing across; x(t) = -1.5 + d e^(t - t0).
  const auto v = [](Vec3 x, double t) { return Vec3(x.x + 1.5, 0.5 * std::cos(3 * t), 0); };
  const auto box = [](double) -> Mesh { return grid(33, {-2, -2, -2}, {2, 2, 2}, 5); };
  Context context;
  auto p = seeded_at<StreaklinesParams>({-1.4, 0, 0});
  p.interpolation = TimeInterpolation::cubic, p.integration.tolerance = 1e-8, p.spacing = 0.02;
  const Lines lines{streaklines(series_of(even_times(0, 2, 41), box, v), {}, p, context)};
  CHECK(lines.points() > 60);
  for (size_t i = 0; i < lines.points(); ++i) {
    const double age = lines.value("age", i), t0 = 2 - age;
    const Vec3 truth(-1.5 + 0.1 * std::exp(age), 0.5 / 3 * (std::sin(6.0) - std::sin(3 * t0)), 0);
    CHECK(length(lines.x(i) - truth) < 2e-4);
    if (i > 0) CHECK(length(lines.x(i) - lines.x(i - 1)) < 0.0201);
  }
  p.refine = false;
  const Lines plain{streaklines(series_of(even_times(0, 2, 41), box, v), {}, p, context)};
  CHECK(plain.points() == 41);
  p.refine = true, p.most_points = 45;
  std::string told;
  context.on_log = [&](LogLevel, std::string_view text) { told += text; };
  const Lines few{streaklines(series_of(even_times(0, 2, 41), box, v), {}, p, context)};
  CHECK(few.points() <= 45);
  CHECK(told.find("most_points") != std::string::npos);
}

TEST_CASE("streaklines: no gaps where releases of one moment have parted") {
  // In the double gyre neighbours part by up to e in a unit of time: what was released within 1e-13 lies far apart after 40.
  Context context;
  auto p = seeded_at<StreaklinesParams>({0.9, 0.5, 0, 1.02, 0.3, 0});
  p.spacing = 0.05;
  const Lines lines{streaklines(gyre_series(32, even_times(0, 40, 161)), {}, p, context)};
  CHECK(lines.mesh().lines.size() == 2);
  bool one_moment = false;
  for (size_t l = 0; l < lines.mesh().lines.size(); ++l)
    for (auto i = size_t(lines.mesh().lines.offsets.get(l)); i + 1 < size_t(lines.mesh().lines.offsets.get(l + 1)); ++i) {
      CHECK(length(lines.x(i + 1) - lines.x(i)) < 0.0501);
      one_moment = one_moment || lines.value("age", i + 1) - lines.value("age", i) < 1e-13;
    }
  CHECK(one_moment);
}

TEST_CASE("streaklines: refined lines have the same bytes for any number of threads") {
  Context context;
  const Series series = gyre_series(32, even_times(0, 8, 17));
  const auto lines = [&](int threads) {
    set_thread_count(threads);
    StreaklinesParams p;
    p.seeds.count = 200, p.spacing = 0.02;
    const DatasetPtr d = streaklines(series, {}, p, context);
    set_thread_count(0);
    return d;
  };
  const DatasetPtr one = lines(1), eight = lines(8);
  CHECK(one->point_count() > 200 * 17 * 2);
  check_same_bytes(*one, *eight);
}

TEST_CASE("streaklines: a line is torn by what lies in its way") {
  // An island in a uniform stream: nothing goes through it.
  const auto v = [](Vec3 x, double t) {
    return std::abs(x.x) < 0.3 && std::abs(x.y) < 0.3 ? Vec3(NAN, 0, 0) : Vec3(1, 0.9 * std::cos(4 * t), 0);
  };
  const auto box = [](double) -> Mesh { return grid(81, {-2, -2, 0}, {2, 2, 0}, 1); };
  Context context;
  auto p = seeded_at<StreaklinesParams>({-1.5, 0, 0});
  p.spacing = 0.05;
  const Lines lines{streaklines(series_of(even_times(0, 2.5, 26), box, v), {}, p, context)};
  for (size_t l = 0; l < lines.mesh().lines.size(); ++l)
    for (auto i = size_t(lines.mesh().lines.offsets.get(l)); i + 1 < size_t(lines.mesh().lines.offsets.get(l + 1)); ++i) {
      const Vec3 a = lines.x(size_t(lines.mesh().lines.connectivity.get(i))),
                 b = lines.x(size_t(lines.mesh().lines.connectivity.get(i + 1)));
      CHECK(length(b - a) < 0.051);
    }
}

TEST_CASE("unsteady: the parts of a collection are one flow") {
  const auto halves = [](bool cut) {
    Series s;
    s.times = even_times(0, 2, 9);
    s.load = [cut, times = s.times](size_t k) -> Data {
      const auto at = [&](Vec3 x) { return oscillating(x, times[k]); };
      if (!cut) return test::with_velocity(grid(9, {-2, -2, -2}, {2, 2, 2}), at);
      UniformGrid left = grid(9, {-2, -2, -2}, {2, 2, 2}), right = left;
      left.dims[0] = right.dims[0] = 5, right.origin.x = 0;
      Collection c;
      c.parts = {{"left", test::with_velocity(left, at)}, {"right", test::with_velocity(right, at)}};
      return std::make_shared<const Collection>(c);
    };
    return s;
  };
  Context context;
  auto p = seeded_at<PathlinesParams>({-0.5, 0.1, 0.2, -1, -0.3, 0});
  p.integration.tolerance = 1e-8, p.interpolation = TimeInterpolation::cubic;
  const Lines one{pathlines(halves(false), {}, p, context)}, two{pathlines(halves(true), {}, p, context)};
  REQUIRE(two.mesh().lines.size() == 2);
  const size_t a = one.points() - 1, b = two.points() - 1;
  CHECK(two.value("time", b) == 2);
  CHECK(length(one.x(a) - two.x(b)) < 1e-5);
  CHECK(length(two.x(size_t(two.mesh().lines.offsets.get(1)) - 1) - went({-0.5, 0.1, 0.2}, 0, 2)) < 3e-3);
}

TEST_CASE("unsteady: times that do not grow, and steps without the field, are named") {
  Context context;
  Series s = series_of({0, 1, 1, 2}, big_box, oscillating);
  auto p = seeded_at<PathlinesParams>({0, 0, 0});
  CHECK(test::error_of([&] { pathlines(s, {}, p, context); }).find("step 1 has 1, step 2 has 1") != std::string::npos);
  s = series_of({0, 1, 2}, big_box, oscillating);
  const auto load = s.load;
  s.load = [load](size_t k) -> Data {
    DatasetParts parts = std::get<DatasetPtr>(load(k))->parts();
    parts.notes.emplace_back("file", "flow_" + std::to_string(k) + ".vtu");
    if (k == 2) parts.fields = {};
    return make_dataset(std::move(parts));
  };
  const std::string message = test::error_of([&] { pathlines(s, {}, p, context); });
  CHECK(message.find("inspecting 'flow_2.vtu'") != std::string::npos);
  CHECK(message.find("loading time step 2 (time 2)") != std::string::npos);
}
