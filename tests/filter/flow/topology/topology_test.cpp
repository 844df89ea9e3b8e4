// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/topology.h"

#include <map>

#include "base/parallel.h"
#include "data/memory/memory_budget.h"
#include "filter/flow/topology/topology_support.h"
#include "filter/surface/surface_shapes.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test::topology;

namespace {

struct Found {
  CriticalPoints critical;
  std::vector<SwitchPoint> border;
  std::vector<Separatrix> lines;
};
Found all_of(const DatasetPtr& d) {
  Context context;
  const FlowParts flow(d, "", "test", context);
  Found f;
  f.critical = find_critical_points(flow, {.centre = 0.01}, context);
  if (f.critical.plane) f.border = find_switch_points(flow, *f.critical.plane, context);
  SeparatrixOptions o;
  o.trace.tolerance = 1e-6;
  f.lines = find_separatrices(flow, f.critical, f.border, o, context);
  return f;
}

const DatasetPtr* part_of(const CollectionPtr& c, const std::string& name) {
  for (const auto& p : c->parts)
    if (p.name == name) return &std::get<DatasetPtr>(p.data);
  return nullptr;
}

}  // namespace

TEST_CASE("separatrices: those of a linear saddle are its eigenvectors, in and out") {
  const Vec3 out = normalize(Vec3(2, 1, 0)), in = normalize(Vec3(-1, 1, 0));
  const DatasetPtr d = plane_grid(21, 21, -1, 1, -1, 1, [&](Vec3 x) {
    const double det = out.x * in.y - out.y * in.x, a = (x.x * in.y - x.y * in.x) / det, b = (out.x * x.y - out.y * x.x) / det;
    return 1.5 * a * out - b * in;
  });
  const Found f = all_of(d);
  size_t saddles = 0;
  for (const Separatrix& s : f.lines) {
    if (s.origin != Separatrix::Origin::saddle) continue;
    ++saddles;
    for (const Vec3 p : s.points) CHECK(std::abs(cross(s.unstable ? out : in, p).z) < 1e-5);
    const Vec3 end = s.points.back();
    CHECK(std::max(std::abs(end.x), std::abs(end.y)) == doctest::Approx(1).epsilon(1e-3));
    CHECK(length(s.points[0]) < 1e-12);
  }
  CHECK(saddles == 4);
}

TEST_CASE("separatrices: those of Taylor-Green vortices run straight from saddle to saddle") {
  const DatasetPtr d = plane_grid(53, 53, 0.3, 6.8, 0.2, 6.9, taylor_green);
  const Found f = all_of(d);
  size_t joined = 0;
  for (const Separatrix& s : f.lines) {
    if (s.origin != Separatrix::Origin::saddle) continue;
    const Vec3 from = f.critical.points[size_t(s.from)].at;
    for (const Vec3 p : s.points) CHECK(std::min(std::abs(p.x - from.x), std::abs(p.y - from.y)) < 0.06);
    joined += s.to >= 0;
    if (s.to >= 0) CHECK(length(from - f.critical.points[size_t(s.to)].at) == doctest::Approx(3.14159).epsilon(0.02));
  }
  CHECK(joined >= 8);
}

TEST_CASE("separatrices: end at the sink they come to") {
  // x' = x - x^3, y' = -y: a saddle between two sinks.
  const DatasetPtr d = plane_grid(41, 21, -1.5, 1.5, -1, 1, [](Vec3 x) { return Vec3(x.x - x.x * x.x * x.x, -x.y + 0.1 * x.x * x.x, 0); });
  const Found f = all_of(d);
  REQUIRE(f.critical.points.size() == 3);
  size_t at_sinks = 0;
  for (const Separatrix& s : f.lines) {
    if (!s.unstable) continue;
    REQUIRE(s.to >= 0);
    CHECK(is_attracting(f.critical.points[size_t(s.to)].flow.type));
    CHECK(length(s.points.back() - f.critical.points[size_t(s.to)].at) < 1e-12);
    ++at_sinks;
  }
  CHECK(at_sinks == 2);
}

TEST_CASE("separatrices: in space, two lines and a circle a saddle") {
  const DatasetPtr d = cube_grid(9, -1, 1, [](Vec3 x) { return Vec3(x.x - 0.1, x.y + 0.2, -2 * (x.z - 0.05)); });
  const Found f = all_of(d);
  REQUIRE(f.critical.points.size() == 1);
  CHECK(f.critical.points[0].flow.type == CriticalType::saddle_1_in);
  REQUIRE(f.lines.size() == 2);
  for (const Separatrix& s : f.lines) {
    CHECK_FALSE(s.unstable);
    for (const Vec3 p : s.points) CHECK(std::hypot(p.x - 0.1, p.y + 0.2) < 1e-6);
    CHECK(std::abs(s.points.back().z) == doctest::Approx(1).epsilon(1e-3));
  }
  const auto circles = separatrix_circles(f.critical, 0.3, 20);
  REQUIRE(circles.size() == 1);
  CHECK(circles[0].points.size() == 21);
  CHECK(circles[0].points.front() == circles[0].points.back());
  for (const Vec3 p : circles[0].points) {
    CHECK(p.z == doctest::Approx(0.05));
    CHECK(length(p - f.critical.points[0].at) == doctest::Approx(0.3 * f.critical.points[0].size));
  }
}

TEST_CASE("switch points: where flow along the border turns from out to in, and which are touched from inside") {
  // A parabola's family over y = 0: v = (1, x - 0.1) touches the lower border from above, at x = 0.1; the upper one from outside.
  const DatasetPtr d = plane_grid(21, 11, -1, 1, 0, 1, [](Vec3 x) { return Vec3(1, x.x - 0.1, 0); });
  const Found f = all_of(d);
  std::map<SwitchType, std::vector<Vec3>> by;
  for (const SwitchPoint& p : f.border) by[p.type].push_back(p.at);
  REQUIRE(by[SwitchType::inner].size() == 1);
  CHECK(length(by[SwitchType::inner][0] - Vec3(0.1, 0, 0)) < 1e-10);
  bool upper = false;
  for (const Vec3 p : by[SwitchType::outer]) upper = upper || length(p - Vec3(0.1, 1, 0)) < 1e-10;
  CHECK(upper);
  size_t lines = 0;
  for (const Separatrix& s : f.lines) {
    ++lines;
    CHECK(s.origin == Separatrix::Origin::border);
    for (const Vec3 p : s.points) CHECK(p.y == doctest::Approx((p.x - 0.1) * (p.x - 0.1) / 2).epsilon(0.02).scale(1));
  }
  CHECK(lines == 2);
}

TEST_CASE("switch points: the corners of a square in uniform flow are touched from outside") {
  const Found f = all_of(plane_grid(6, 6, 0, 1, 0, 1, [](Vec3) { return Vec3(1, 0.3, 0); }));
  CHECK(f.border.size() == 2);
  for (const SwitchPoint& p : f.border) {
    CHECK(p.type == SwitchType::outer);
    CHECK((length(p.at - Vec3(1, 0, 0)) < 1e-12 || length(p.at - Vec3(0, 1, 0)) < 1e-12));
  }
  CHECK(f.lines.empty());
  // Along the border everywhere: nothing changes.
  CHECK(all_of(plane_grid(17, 9, 0, 2, 0, 1, [](Vec3 x) { return double_gyre(x, 0); })).border.empty());
}

TEST_CASE("switch points: flow leaves a wall where the shear along it vanishes") {
  // u = y (x^2 - 1/4), v = -x y^2: no slip at y = 0; comes to the wall at x = 1/2, leaves at x = -1/2... by the sign of x.
  const DatasetPtr d = plane_grid(42, 21, -1, 1, 0, 1, [](Vec3 x) { return Vec3(x.y * (0.25 - x.x * x.x), x.x * x.y * x.y, 0); });
  const Found f = all_of(d);
  std::map<SwitchType, std::vector<Vec3>> by;
  for (const SwitchPoint& p : f.border) by[p.type].push_back(p.at);
  REQUIRE(by[SwitchType::detachment].size() == 1);
  REQUIRE(by[SwitchType::attachment].size() == 1);
  CHECK(length(by[SwitchType::detachment][0] - Vec3(0.5, 0, 0)) < 0.01);
  CHECK(length(by[SwitchType::attachment][0] - Vec3(-0.5, 0, 0)) < 0.01);
  size_t away = 0;
  for (const Separatrix& s : f.lines)
    if (s.origin == Separatrix::Origin::border && s.points[0].y == 0) away += s.points.back().y > 0.5;
  CHECK(away == 2);
}

TEST_CASE("topology: all parts together, the same for any number of threads, on a plane, a surface and in space") {
  Context context;
  const DatasetPtr plane = plane_grid(81, 81, -3, 3, -4, 4, [](Vec3 x) { return Vec3(x.y, (1 - x.x * x.x) * x.y - x.x, 0); });
  std::string told;
  context.on_log = [&](LogLevel, std::string_view t) { told += t; };
  const CollectionPtr c = topology(plane, {}, context);
  REQUIRE(part_of(c, "critical points"));
  REQUIRE(part_of(c, "closed orbits"));
  CHECK((*part_of(c, "critical points"))->point_count() == 1);
  CHECK((*part_of(c, "closed orbits"))->cell_count() == 1);
  CHECK(told.find("1 repelling focus") != std::string::npos);
  CHECK(told.find("1 periodic orbit") != std::string::npos);

  const DatasetPtr cube = cube_grid(20, 0, 6, abc);
  set_thread_count(1);
  const CollectionPtr one = topology(cube, {}, context);
  set_thread_count(8);
  const CollectionPtr eight = topology(cube, {}, context);
  set_thread_count(0);
  REQUIRE(part_of(one, "separatrices"));
  CHECK(part_of(one, "separation circles"));
  CHECK(sg::test::meshes::same_surface(**part_of(one, "separatrices"), **part_of(eight, "separatrices")));

  // x^2 - y^2 + 2 z^2 over the sphere: its saddles send lines to its sinks.
  const DatasetPtr sphere =
      with_velocity(sg::test::shapes::sphere(4).dataset(), [](Vec3 x) { return Vec3(-x.x, 0.2 * x.y, 2 * x.z) + 0.01 * Vec3(1, 2, 3); });
  const CollectionPtr s = topology(sphere, {}, context);
  REQUIRE(part_of(s, "separatrices"));
  const Dataset& lines = **part_of(s, "separatrices");
  CHECK(lines.cell_count() == 8);
  const Array to = lines.fields().require("to").array;
  std::map<double, int> arrivals;
  for (size_t i = 0; i < to.count(); ++i) ++arrivals[to.get(i)];
  CHECK(arrivals.size() == 4);  // two sinks, two sources
  for (const auto& [point, n] : arrivals) {
    CHECK(point >= 0);
    CHECK(n == 2);
  }
  for (size_t i = 0; i < lines.point_count(); ++i) CHECK(length(lines.as<SurfaceMesh>()->points.at(i)) == doctest::Approx(1).epsilon(0.01));
}

TEST_CASE("topology seeds: patterns about the critical points, inside the mesh") {
  Context context;
  TopologySeedsParams p;
  p.count = 12;
  const DatasetPtr d = plane_grid(53, 53, 0.3, 6.8, 0.2, 6.9, taylor_green);
  const DatasetPtr seeds = topology_seeds(d, p, context);
  CHECK(seeds->point_count() > 80);
  const Box3 box = d->bounds();
  for (size_t i = 0; i < seeds->point_count(); ++i) {
    const Vec3 x = seeds->as<PointCloud>()->points.at(i);
    CHECK(x.x >= box.lo.x);
    CHECK(x.x <= box.hi.x);
  }
  const DatasetPtr none = plane_grid(5, 5, 0, 1, 0, 1, [](Vec3) { return Vec3(1, 0, 0); });
  std::string told;
  context.on_log = [&](LogLevel l, std::string_view t) { told += l == LogLevel::warning ? t : ""; };
  CHECK(topology_seeds(none, p, context)->point_count() == 0);

  TopologySeedsParams many;
  many.count = 1'000'000;
  set_memory_limit(array_memory() + (size_t(64) << 20));
  std::string said;
  try {
    topology_seeds(d, many, context);
  } catch (const Error& e) {
    said = e.what();
  }
  set_memory_limit(0);
  CHECK(said.find("1000000 seeds around each of") != std::string::npos);
  CHECK(told.find("no critical point") != std::string::npos);
  const DatasetPtr solid = topology_seeds(cube_grid(20, 0, 6, abc), p, context);
  CHECK(solid->point_count() > 50);
}
