// SPDX-License-Identifier: Apache-2.0
// Path-, streak-, time- and streamlines of flows with closed forms, on every kind of mesh (correctness.md F3).
#include "filter/every_mesh.h"
#include "filter/flow/streamlines.h"
#include "filter/flow/unsteady/pathlines.h"
#include "filter/flow/unsteady/streaklines.h"
#include "filter/flow/unsteady/timelines.h"
#include "filter/flow/unsteady/unsteady_lines.h"
#include "filter/mesh/transform/transform.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::unsteady;

namespace {

// u = (U, V cos wt + S x): all four lines differ.
constexpr double S = 0.6;
Vec3 sheared(Vec3 x, double t) { return oscillating(x, t) + Vec3(0, S * x.x, 0); }
Vec3 carried(Vec3 from, double t0, double t1) {
  const double t = t1 - t0;
  return went(from, t0, t1) + Vec3(0, S * (from.x * t + U * t * t / 2), 0);
}

// x' = (1 + t) A x turns about z by the angle t + t^2/2, and is linear in time.
Vec3 turning(Vec3 x, double t) { return (1 + t) * Vec3(-x.y, x.x, 0); }
Vec3 turned(Vec3 x, double t) {
  const double a = t + t * t / 2;
  return {std::cos(a) * x.x - std::sin(a) * x.y, std::sin(a) * x.x + std::cos(a) * x.y, x.z};
}

using Flow = Vec3 (*)(Vec3, double);

/// The flow on meshes that stay, at `steps` times from 0 to `end`.
Series on_meshes(const std::vector<DatasetPtr>& meshes, size_t steps, double end, Flow u) {
  Series s;
  s.times = even_times(0, end, steps);
  s.load = [meshes, u, times = s.times](size_t k) -> Data {
    const auto with = [&](const DatasetPtr& d) {
      DatasetParts parts = d->parts();
      parts.fields.add({"u", Association::point, at_points(d->mesh(), [&](Vec3 x) { return u(x, times[k]); }), "", Role::vectors});
      return make_dataset(std::move(parts));
    };
    if (meshes.size() == 1) return with(meshes[0]);
    return collection_of(meshes, with);
  };
  return s;
}

struct Case {
  std::string name;
  bool flat;
  std::vector<DatasetPtr> meshes;
};
std::vector<Case> cases(int n, double r) {
  std::vector<Case> all;
  for (const MeshKind& k : every_mesh()) all.push_back({k.name, k.flat, {k.make(n, r)}});
  all.push_back({"parts", false, halves(false, n, r)});
  all.push_back({"flat parts", true, halves(true, n, r)});
  return all;
}

constexpr double end_time = 1.5;

void check_closed_forms(const Case& c) {
  Context context;
  const Series series = on_meshes(c.meshes, 16, end_time, sheared);
  const double z = c.flat ? 0 : 0.2;
  const Vec3 seeds[] = {{-0.9, 0.3, z}, {-0.3, 0.1, -z}};
  const std::vector<double> list{-0.9, 0.3, z, -0.3, 0.1, -z};
  const auto with = [&](auto p) {
    p.interpolation = TimeInterpolation::cubic, p.integration.tolerance = 1e-5;
    return p;
  };
  const Lines paths{pathlines(series, {}, with(seeded_at<PathlinesParams>(list)), context)};
  StreaklinesParams released = with(seeded_at<StreaklinesParams>(list));
  const Lines refined{streaklines(series, {}, released, context)};
  released.refine = false;
  const Lines streaks{streaklines(series, {}, released, context)};
  TimelinesParams tp = with(TimelinesParams());
  tp.seeds.from = seeds[0], tp.seeds.to = seeds[1], tp.seeds.count = 5, tp.every = 0.5;
  const Lines times{timelines(series, {}, tp, context)};
  StreamlinesParams sp = seeded_at<StreamlinesParams>(list);
  sp.direction = TraceDirection::forward, sp.integration.tolerance = 1e-7, sp.stop.max_time = 1.2;
  const Lines streams{std::get<DatasetPtr>(streamlines({series.load(15)}, sp, context))};

  double worst[5] = {0, 0, 0, 0, 0};
  REQUIRE(paths.mesh().lines.size() == 2);
  REQUIRE(streaks.mesh().lines.size() == 2);
  REQUIRE(streams.mesh().lines.size() == 2);
  REQUIRE(times.mesh().lines.size() == 4);
  const auto each = [](const Lines& l, auto&& f) {
    for (size_t k = 0; k < l.mesh().lines.size(); ++k)
      for (auto i = size_t(l.mesh().lines.offsets.get(k)); i < size_t(l.mesh().lines.offsets.get(k + 1)); ++i) f(k, i);
  };
  each(paths,
       [&](size_t k, size_t i) { worst[0] = std::max(worst[0], length(paths.x(i) - carried(seeds[k], 0, paths.value("time", i)))); });
  each(streaks, [&](size_t k, size_t i) {
    worst[1] = std::max(worst[1], length(streaks.x(i) - carried(seeds[k], end_time - streaks.value("age", i), end_time)));
  });
  each(refined, [&](size_t k, size_t i) {
    worst[4] = std::max(worst[4], length(refined.x(i) - carried(seeds[k], end_time - refined.value("age", i), end_time)));
  });
  each(times, [&](size_t, size_t i) {
    const Vec3 from = seeds[0] + times.value("position", i) * (seeds[1] - seeds[0]);
    worst[2] = std::max(worst[2], length(times.x(i) - carried(from, 0, times.value("time", i))));
  });
  each(streams, [&](size_t k, size_t i) {  // the flow of the last time stands still
    const double t = streams.value("time", i), v = V * std::cos(w * end_time);
    const Vec3 at = seeds[k] + Vec3(U * t, v * t + S * (seeds[k].x * t + U * t * t / 2), 0);
    worst[3] = std::max(worst[3], length(streams.x(i) - at));
  });
  CHECK(paths.value("time", paths.points() - 1) == doctest::Approx(end_time));
  CHECK(streaks.points() == 32);
  CHECK(refined.points() > 32);
  CHECK(worst[0] < 5e-4);  // cubic in time, steps of 1/10
  CHECK(worst[1] < 5e-4);
  CHECK(worst[2] < 5e-4);
  CHECK(worst[4] < 1e-3);  // and cubic in the time of release between those
  CHECK(worst[3] < 1e-6);
  // They are four lines, not one.
  const Vec3 path_end = carried(seeds[0], 0, end_time), streak_middle = carried(seeds[0], end_time / 2, end_time);
  CHECK(length(path_end - carried(seeds[0], 0, end_time / 2)) > 0.1);
  CHECK(std::abs(streak_middle.y - carried(seeds[0], 0, end_time / 2).y) > 0.05);
}

}  // namespace

TEST_CASE("unsteady meshes: path-, streak-, time- and streamlines have their closed forms in every kind of mesh (F3)") {
  for (const Case& c : cases(5, 1.25)) {
    CAPTURE(c.name);
    check_closed_forms(c);
  }
}

TEST_CASE("unsteady meshes: RK4 has order 4 along pathlines in every kind of mesh (F3)") {
  // Linear in space and time: what the steps between hold is exact, so that only steps in time count.
  for (const Case& c : cases(5, 1.25)) {
    CAPTURE(c.name);
    Context context;
    const Series series = on_meshes(c.meshes, 2, 1, turning);
    auto p = seeded_at<PathlinesParams>({0.7, -0.3, c.flat ? 0 : 0.3});
    p.integration.integrator = Scheme::rk4, p.integration.step_unit = StepUnit::time;
    double h[4], error[4];
    for (int k = 0; k < 4; ++k) {
      p.integration.step = h[k] = 0.25 / (1 << k);
      const Lines l{pathlines(series, {}, p, context)};
      error[k] = length(l.x(l.points() - 1) - turned({0.7, -0.3, c.flat ? 0 : 0.3}, 1));
    }
    CHECK(observed_order(h, error, 4) == doctest::Approx(4).epsilon(0.06));
  }
}

TEST_CASE("unsteady meshes: pathlines have their closed form in meshes of every kind that move (F3)") {
  for (const MeshKind& kind : every_mesh()) {
    CAPTURE(kind.name);
    Context context;
    const DatasetPtr mesh = kind.make(4, 1.25);
    Series s;
    s.times = {0, 0.5, 1};
    s.load = [&](size_t k) -> Data {
      const double t = s.times[k];
      TransformParams p;
      p.translate = {-0.2 * t, 0.1 * t, 0};
      Context own;
      return flow::with_velocity(transform(mesh, p, own), [t](Vec3 x) { return Vec3(0.4, 0.3 * t + 0.2 * x.x, 0); });
    };
    auto p = seeded_at<PathlinesParams>({-0.4, -0.3, 0});
    p.integration.tolerance = 1e-8;
    const Lines l{pathlines(s, {}, p, context)};
    REQUIRE(l.value("time", l.points() - 1) == 1);
    for (size_t i = 0; i < l.points(); ++i) {
      const double t = l.value("time", i);
      CHECK(length(l.x(i) - Vec3(-0.4 + 0.4 * t, -0.3 + 0.15 * t * t + 0.2 * (-0.4 * t + 0.2 * t * t), 0)) < 1e-3);
    }
  }
}
