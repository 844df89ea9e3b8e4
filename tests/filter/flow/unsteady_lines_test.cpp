// SPDX-License-Identifier: Apache-2.0
#include <cstring>

#include "base/parallel.h"
#include "filter/flow/unsteady/advance_one.h"
#include "filter/flow/unsteady/pathlines.h"
#include "filter/flow/unsteady/streaklines.h"
#include "filter/flow/unsteady/timelines.h"
#include "filter/flow/unsteady_inputs.h"
#include "filter/mesh/to_unstructured.h"
#include "support/test.h"

using namespace sg;
using test::even_times;
using test::grid;
using test::series_of;

namespace {

// u = (U, V cos wt): stream-, path- and streaklines differ, all have closed forms.
constexpr double U = 0.4, V = 0.7, w = 2.5;
const auto oscillating = [](Vec3, double t) { return Vec3(U, V * std::cos(w * t), 0); };
Vec3 went(Vec3 from, double t0, double t1) { return from + Vec3(U * (t1 - t0), V / w * (std::sin(w * t1) - std::sin(w * t0)), 0); }

const auto big_box = [](double) -> Mesh { return grid(5, {-2, -2, -2}, {2, 2, 2}); };

Series oscillating_series(size_t steps, double end = 2, bool f32 = false) {
  return series_of(even_times(0, end, steps), big_box, oscillating, f32);
}

// The double gyre of Shadden et al. 2005 in [0, 2] x [0, 1].
const auto gyre = [](Vec3 x, double t) {
  const double a = 0.25 * std::sin(2 * M_PI * t / 10), b = 1 - 2 * a, f = a * x.x * x.x + b * x.x;
  return Vec3(-M_PI * 0.1 * std::sin(M_PI * f) * std::cos(M_PI * x.y),
              M_PI * 0.1 * std::cos(M_PI * f) * std::sin(M_PI * x.y) * (2 * a * x.x + b), 0);
};
Series gyre_series(size_t n, std::vector<double> times) {
  return series_of(
      std::move(times),
      [n](double) -> Mesh {
        UniformGrid g;
        g.dims = {2 * n + 1, n + 1, 1};
        g.spacing = {1.0 / double(n), 1.0 / double(n), 1};
        return g;
      },
      gyre);
}

template <class P>
P at_points(std::vector<double> points) {
  P p;
  p.seeds.points = std::move(points);
  return p;
}

struct Lines {
  DatasetPtr data;
  const SurfaceMesh& mesh() const { return *data->as<SurfaceMesh>(); }
  Vec3 x(size_t i) const { return mesh().points.at(i); }
  double value(const char* field, size_t i) const { return data->fields().require(field).array.get(i); }
  size_t points() const { return data->point_count(); }
};

void check_same_bytes(const Dataset& a, const Dataset& b) {
  REQUIRE(a.fields().size() == b.fields().size());
  const Points& p = a.as<SurfaceMesh>() ? a.as<SurfaceMesh>()->points : a.as<PointCloud>()->points;
  const Points& q = b.as<SurfaceMesh>() ? b.as<SurfaceMesh>()->points : b.as<PointCloud>()->points;
  REQUIRE(p.count() == q.count());
  CHECK(std::memcmp(p.xyz.raw(), q.xyz.raw(), p.xyz.bytes()) == 0);
  for (const Field& f : a.fields()) {
    const Array& other = b.fields().require(f.name, f.association).array;
    REQUIRE(other.bytes() == f.array.bytes());
    CHECK(std::memcmp(other.raw(), f.array.raw(), f.array.bytes()) == 0);
  }
}

}  // namespace

TEST_CASE("unsteady: RK4 follows the oscillating flow with order 4, the other schemes with theirs") {
  for (const Scheme scheme : {Scheme::euler, Scheme::midpoint, Scheme::heun, Scheme::rk4}) {
    double h[4], error[4];
    for (int i = 0; i < 4; ++i) {
      // A shear beside the oscillation, so that places matter as well: y' = V cos wt + x, x = x0 + U t.
      AnalyticFlow flow{[](Vec3 x, double t) { return oscillating(x, t) + Vec3(0, x.x, 0); }};
      TraceOptions o;
      o.scheme = scheme, o.unit = TraceOptions::Unit::time, o.step = h[i] = 0.25 / double(1 << i);
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
      auto p = at_points<PathlinesParams>({-1, 0, 0, -0.5, 0.3, 0.2});
      p.interpolation = how, p.integration.tolerance = 1e-9;
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
  auto p = at_points<PathlinesParams>({-1, 0, 0.5});
  p.interpolation = "cubic", p.start = 0.25, p.time = 1.75, p.integration.tolerance = 1e-8;
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

TEST_CASE("streaklines: the oscillating flow has its closed form, the newest particle first") {
  for (const std::optional<double> every : {std::optional<double>(), std::optional<double>(0.03)}) {
    Context context;
    auto p = at_points<StreaklinesParams>({-1, 0, 0, -0.5, 0.3, 0.2});
    p.every = every, p.interpolation = "cubic";
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
  auto p = at_points<StreaklinesParams>({0, 0, 0});
  const Lines lines{streaklines(series_of(even_times(0, 4, 5), big_box, v), {}, p, context)};
  CHECK(lines.mesh().vertices.size() + lines.mesh().lines.size() >= 1);
  CHECK(lines.points() < 5);
  const Lines still{streaklines(
      oscillating_series(5, 1), {},
      [] {
        auto q = at_points<StreaklinesParams>({0, 0, 0});
        q.time = 0;
        return q;
      }(),
      context)};
  CHECK(still.mesh().vertices.size() == 1);
  CHECK(still.points() == 1);
}

TEST_CASE("particles: released once, with a lifetime, and as many as streaklines have points") {
  Context context;
  auto p = at_points<ParticlesParams>({-1, 0, 0, -0.5, 0.3, 0.2});
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
  p.seeds.from = Vec3(-1, -0.5, 0), p.seeds.to = Vec3(-1, 0.5, 0), p.seeds.count = 5, p.every = 0.5, p.interpolation = "cubic";
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

TEST_CASE("unsteady: in a steady flow path-, streak- and streamlines are one") {
  const auto steady = [](Vec3 x, double) { return Vec3(-x.y, x.x, 0.1); };
  const auto fine = [](double) -> Mesh { return grid(41, {-2, -2, -2}, {2, 2, 2}); };
  const Series series = series_of(even_times(0, 3, 61), fine, steady);
  Context context;
  auto path = at_points<PathlinesParams>({1, 0, 0});
  path.integration.tolerance = 1e-8;
  auto streak = at_points<StreaklinesParams>({1, 0, 0});
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
  auto p = at_points<PathlinesParams>({0.4, 0.3, 0, 1.5, 0.7, 0, 0.95, 0.5, 0});
  p.interpolation = "cubic", p.integration.tolerance = 1e-7;
  const Lines lines{pathlines(series, {}, p, context)};
  for (size_t l = 0; l < 3; ++l) {
    AnalyticFlow flow{gyre};
    TraceOptions o;
    o.scheme = Scheme::rk4, o.unit = TraceOptions::Unit::time, o.step = 0.01;
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
    auto p = at_points<PathlinesParams>({0.01, 0.5, 0.5, 0.5, 0.2, 0.9});
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
  const Lines lines{pathlines(series_of(even_times(0, 1, 5), mesh, oscillating), {}, at_points<PathlinesParams>({-1, 0, 0}), context)};
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
  const Lines lines{pathlines(series_of({0, 0.25, 0.5, 1}, big_box, v), {}, at_points<PathlinesParams>({-1, 0, 0}), context)};
  CHECK(length(lines.x(lines.points() - 1) - Vec3(-0.875, 0, 0)) < 1e-6);
  CHECK(lines.data->fields().require("stop", Association::cell).array.get(0) == int(StopReason::time));
}

TEST_CASE("unsteady: particles that leave end at the border, those in NaN do not begin") {
  const auto v = [](Vec3 x, double t) { return x.y > 1.2 ? Vec3(NAN, 0, 0) : Vec3(1, 0.1 * t, 0); };
  Context context;
  const Lines lines{
      pathlines(series_of(even_times(0, 2, 5), big_box, v), {}, at_points<PathlinesParams>({1, 0, 0, 0, 1.9, 0, 9, 9, 9}), context)};
  REQUIRE(lines.mesh().lines.size() == 1);
  CHECK(std::abs(lines.x(lines.points() - 1).x - 2) < 0.01);
  CHECK(lines.data->fields().require("stop", Association::cell).array.get(0) == int(StopReason::outside));
  const std::string none = test::error_of([&] {
    pathlines(series_of({0, 1}, big_box, v), {}, at_points<PathlinesParams>({9, 9, 9}), context);
  });
  CHECK(none.find("none of 1 seeds lies in the flow; the mesh lies in x -2 to 2") != std::string::npos);
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
  auto path = at_points<PathlinesParams>({0, 0, 0});
  CHECK(message(path, oscillating_series(1)).find("streamlines") != std::string::npos);
  path.start = 5;
  CHECK(message(path, oscillating_series(3)).find("start=5 lies outside the series; it goes from 0 to 2") != std::string::npos);
  auto streak = at_points<StreaklinesParams>({0, 0, 0});
  streak.start = 1, streak.time = 0.5;
  CHECK(message(streak, oscillating_series(3)).find("pathlines go backwards") != std::string::npos);
  streak = at_points<StreaklinesParams>({0, 0, 0});
  streak.every = 1e-12;
  CHECK(message(streak, oscillating_series(3)).find("releases") != std::string::npos);
  TimelinesParams time;
  time.seeds.points = {0, 0, 0};
  CHECK(message(time, oscillating_series(3)).find("makes no line") != std::string::npos);
  CHECK(message(TimelinesParams{}, oscillating_series(3)).find("random seeds make no line") != std::string::npos);
}

TEST_CASE("unsteady: 1,000 steps, two in memory") {
  auto watched = std::make_shared<test::Watched>();
  Context context;
  const Series series = series_of(even_times(0, 2, 1000), big_box, oscillating, true, watched);
  const Lines lines{streaklines(series, {}, at_points<StreaklinesParams>({-1, 0, 0}), context)};
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
      p.interpolation = how;
      if (kind == 2) p.integration.integrator = "rk4";
      else p.integration.tolerance = 1e-6;
      p.seeds.seeds = "grid", p.seeds.counts = {9, 9, flat ? 1 : 5};
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
  const Lines lines{pathlines(series_of(even_times(0, 4, 5), flat, v), {}, at_points<PathlinesParams>({0, 0, 0, 5, 0, 0}), context)};
  REQUIRE(lines.mesh().lines.size() == 1);
  CHECK(std::abs(lines.x(lines.points() - 1).x - 2) < 0.02);
  CHECK(lines.value("time", lines.points() - 1) < 2.1);
  CHECK(lines.data->fields().require("stop", Association::cell).array.get(0) == int(StopReason::outside));
}
