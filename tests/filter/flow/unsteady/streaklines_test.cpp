// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/unsteady/streaklines.h"

#include "filter/flow/unsteady/timelines.h"
#include "filter/flow/unsteady/unsteady_lines.h"

using namespace sg;
using namespace sg::test::unsteady;
using test::even_times;
using test::grid;
using test::series_of;

TEST_CASE("streaklines: the oscillating flow has its closed form, the newest particle first") {
  for (const std::optional<double> every : {std::optional<double>(), std::optional<double>(0.03)}) {
    Context context;
    auto p = seeded_at<StreaklinesParams>({-1, 0, 0, -0.5, 0.3, 0.2});
    p.every = every, p.interpolation = TimeInterpolation::cubic;
    const Lines lines{streaklines(oscillating_series(41, 1.8), {}, p, context)};
    REQUIRE(lines.mesh().lines.size() == 2);
    const size_t per_line = every ? 61 : 41;
    REQUIRE(lines.points() == 2 * per_line);
    CHECK(lines.value("age", 0) == doctest::Approx(0));
    CHECK(lines.value("age", per_line - 1) == doctest::Approx(1.8));
    double worst = 0;
    for (size_t k = 0; k < lines.points(); ++k) {
      const Vec3 seed = k < per_line ? Vec3(-1, 0, 0) : Vec3(-0.5, 0.3, 0.2);
      worst = std::max(worst, length(lines.x(k) - went(seed, 1.8 - lines.value("age", k), 1.8)));
      CHECK(lines.value("speed", k) == doctest::Approx(length(oscillating({}, 1.8))).epsilon(1e-6));
    }
    CHECK(worst < 5e-5);
  }
}

TEST_CASE("streaklines: a line breaks where particles have left, and a lone particle is a vertex") {
  // Up in [0, 1), then away to the right so fast that everything older leaves.
  const auto v = [](Vec3, double t) { return t < 2.5 ? Vec3(0, 0.1, 0) : Vec3(3, 0, 0); };
  Context context;
  auto p = seeded_at<StreaklinesParams>({0, 0, 0});
  const Lines lines{streaklines(series_of(even_times(0, 4, 5), big_box, v), {}, p, context)};
  CHECK(lines.mesh().vertices.size() + lines.mesh().lines.size() >= 1);
  CHECK(lines.points() < 5);
  const Lines still{streaklines(
      oscillating_series(5, 1), {},
      [] {
        auto q = seeded_at<StreaklinesParams>({0, 0, 0});
        q.time = 0;
        return q;
      }(),
      context)};
  CHECK(still.mesh().vertices.size() == 1);
  CHECK(still.points() == 1);
}

TEST_CASE("particles: released once, with a lifetime, and as many as streaklines have points") {
  Context context;
  auto p = seeded_at<ParticlesParams>({-1, 0, 0, -0.5, 0.3, 0.2});
  const DatasetPtr all = particles(oscillating_series(21), {}, p, context);
  CHECK(all->point_count() == 42);
  p.lifetime = 0.55;
  const DatasetPtr young = particles(oscillating_series(21), {}, p, context);
  CHECK(young->point_count() == 12);
  CHECK(young->range(young->fields().require("age")).hi <= 0.55);
  p.lifetime = {}, p.every = 0;
  const DatasetPtr once = particles(oscillating_series(21), {}, p, context);
  REQUIRE(once->point_count() == 2);
  CHECK(length(once->as<PointCloud>()->points.at(1) - went({-0.5, 0.3, 0.2}, 0, 2)) < 2e-3);
  CHECK(once->fields().require("seed").array.get(1) == 1);
}

TEST_CASE("timelines: a shear stretches the line into its closed form, and new points keep it close") {
  // x' = y (1 + t): x = x0 + y (t + t^2/2)
  const auto shear = [](Vec3 x, double t) { return Vec3(x.y * (1 + t), 0, 0); };
  Context context;
  TimelinesParams p;
  p.seeds.from = Vec3(0, -0.5, 0), p.seeds.to = Vec3(0, 0.5, 0), p.seeds.count = 11;
  const Lines lines{timelines(series_of(even_times(0, 1.5, 4), big_box, shear), {}, p, context)};
  REQUIRE(lines.mesh().lines.size() == 4);
  CHECK(lines.data->fields().require("line", Association::cell).array.get(3) == 3);
  CHECK(lines.data->fields().require("time", Association::cell).array.get(2) == doctest::Approx(1));
  double longest = 0;
  for (size_t k = 0; k < lines.points(); ++k) {
    const double t = lines.value("time", k), y = lines.value("position", k) - 0.5;
    CHECK(length(lines.x(k) - Vec3(y * (t + t * t / 2), y, 0)) < 1e-5);
    if (k > 0 && lines.value("time", k - 1) == t) longest = std::max(longest, length(lines.x(k) - lines.x(k - 1)));
  }
  CHECK(longest < 0.1501);
  CHECK(lines.points() > 60);
}

TEST_CASE("timelines: a line in the oscillating flow moves as a whole; bends get points") {
  Context context;
  TimelinesParams p;
  p.seeds.from = Vec3(-1, -0.5, 0), p.seeds.to = Vec3(-1, 0.5, 0), p.seeds.count = 5, p.every = 0.5,
  p.interpolation = TimeInterpolation::cubic;
  const Lines lines{timelines(oscillating_series(41), {}, p, context)};
  REQUIRE(lines.points() == 25);
  for (size_t k = 0; k < 25; ++k)
    CHECK(length(lines.x(k) - went({-1, lines.value("position", k) - 0.5, 0}, 0, lines.value("time", k))) < 1e-4);
  // A vortex winds the line up: neighbours turn by less than the angle allowed, wherever they are not very close.
  const auto vortex = [](Vec3 x, double) { return Vec3(-x.y, x.x, 0) * std::exp(-4 * dot(x, x)) * 12.0; };
  const auto fine = [](double) -> Mesh { return grid(81, {-1, -1, 0}, {1, 1, 0}, 1); };
  p.seeds.from = Vec3(-0.9, 0, 0), p.seeds.to = Vec3(0.9, 0, 0), p.seeds.count = 20, p.every = 2;
  const Lines wound{timelines(series_of(even_times(0, 2, 21), fine, vortex), {}, p, context)};
  const size_t first = size_t(wound.mesh().lines.offsets.get(1));
  size_t sharp = 0;
  for (size_t k = first + 1; k + 1 < wound.points(); ++k) {
    const Vec3 a = wound.x(k) - wound.x(k - 1), b = wound.x(k + 1) - wound.x(k);
    sharp += dot(a, b) < std::cos(16 * M_PI / 180) * length(a) * length(b);
  }
  CHECK(wound.points() > 60);
  CHECK(sharp == 0);
}
