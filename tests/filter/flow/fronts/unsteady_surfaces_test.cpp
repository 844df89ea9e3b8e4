// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/fronts/unsteady_surfaces.h"

#include <algorithm>
#include <cstring>
#include <set>

#include "base/parallel.h"
#include "filter/flow/flow_support.h"
#include "support/test.h"

using namespace sg;

namespace {

constexpr double U = 0.5, V = 0.8, W = 2;  // u = (U, V cos W t, 0)

Series oscillating() {
  Series s;
  for (int k = 0; k <= 40; ++k) s.times.push_back(0.05 * k);
  s.load = [times = s.times](size_t k) -> Data {
    return test::cube_flow(3, -2, 2, [&](Vec3) { return Vec3(U, V * std::cos(W * times[k]), 0); });
  };
  return s;
}

// Where something released at the origin's place `x` at time `from` is at `to`.
Vec3 moved(Vec3 x, double from, double to) { return x + Vec3(U * (to - from), V / W * (std::sin(W * to) - std::sin(W * from)), 0); }

template <class P>
P along_z() {
  P p;
  p.curve.from = Vec3(-0.5, 0, -0.3), p.curve.to = Vec3(-0.5, 0, 0.3);
  p.spacing = 0.1, p.interpolation = TimeInterpolation::cubic, p.integration.tolerance = 1e-7;
  return p;
}

// Every directed edge once: at most two triangles to an edge, which run alike.
void check_manifold(const DatasetPtr& d) {
  const CellsView v = cells_view(d->as<SurfaceMesh>()->polygons);
  std::set<std::pair<int64_t, int64_t>> edges;
  for (size_t c = 0; c < v.count; ++c)
    for (size_t k = 0; k < 3; ++k) CHECK(edges.insert({v.point(c, k), v.point(c, (k + 1) % 3)}).second);
}

double area(const DatasetPtr& d) {
  const SurfaceMesh& m = *d->as<SurfaceMesh>();
  const CellsView v = cells_view(m.polygons);
  double sum = 0;
  for (size_t c = 0; c < v.count; ++c) {
    const Vec3 a = m.points.at(size_t(v.point(c, 0))), b = m.points.at(size_t(v.point(c, 1))), e = m.points.at(size_t(v.point(c, 2)));
    sum += length(cross(b - a, e - a)) / 2;
  }
  return sum;
}

}  // namespace

TEST_CASE("path surface: of an oscillating flow it is the pathline of its closed form, drawn out along the curve") {
  Context context;
  const DatasetPtr d = path_surface(oscillating(), {}, along_z<PathSurfaceParams>(), context);
  check_manifold(d);
  const Field &time = d->fields().require("time"), &s = d->fields().require("seed parameter");
  for (size_t i = 0; i < d->point_count(); ++i) {
    const Vec3 seed(-0.5, 0, -0.3 + 0.6 * s.array.get(i));
    CHECK(length(d->as<SurfaceMesh>()->points.at(i) - moved(seed, 0, time.array.get(i))) < 1e-4);
  }
  // Length of the pathline times that of the curve.
  double arc = 0;
  for (int k = 0; k < 4000; ++k) arc += std::hypot(U, V * std::cos(W * (k + 0.5) / 2000)) / 2000;
  CHECK(area(d) == doctest::Approx(0.6 * arc).epsilon(0.005));
}

TEST_CASE("streak surface: of an oscillating flow it is the streakline of its closed form, drawn out along the curve") {
  Context context;
  const DatasetPtr d = streak_surface(oscillating(), {}, along_z<StreakSurfaceParams>(), context);
  check_manifold(d);
  const Field &born = d->fields().require("release time"), &s = d->fields().require("seed parameter");
  double worst = 0;
  for (size_t i = 0; i < d->point_count(); ++i) {
    const Vec3 seed(-0.5, 0, -0.3 + 0.6 * s.array.get(i));
    worst = std::max(worst, length(d->as<SurfaceMesh>()->points.at(i) - moved(seed, born.array.get(i), 2)));
  }
  CHECK(worst < 2e-3);  // particles put in lie on chords
  CHECK(d->range(born).lo == 0);
  CHECK(d->range(born).hi == 2);
  CHECK(d->bounds().hi.z == doctest::Approx(0.3));
}

TEST_CASE("time surface: a rectangle keeps its shape in uniform wind and its area grows in a flow that pulls") {
  Context context;
  TimeSurfaceParams p;
  p.center = Vec3(-0.5, 0, 0), p.size = {0.4, 0.6}, p.spacing = 0.1, p.interpolation = TimeInterpolation::cubic;
  const DatasetPtr d = time_surface(oscillating(), {}, p, context);
  check_manifold(d);
  CHECK(area(d) == doctest::Approx(0.24).epsilon(1e-4));
  CHECK(length(d->bounds().center() - moved({-0.5, 0, 0}, 0, 2)) < 1e-4);
  // u = (x, -y/2, -z/2): the plane z = 0 grows by e^(1/2) a time.
  Series pull;
  pull.times = {0, 1};
  pull.load = [](size_t) -> Data {
    UniformGrid g;
    g.dims = {3, 3, 3}, g.origin = {-2, -2, -2}, g.spacing = {2, 2, 2};
    std::vector<double> v;
    for (int k = 0; k < 27; ++k) v.insert(v.end(), {2.0 * (k % 3 - 1), -1.0 * (k / 3 % 3 - 1), -1.0 * (k / 9 - 1)});
    FieldSet fields;
    fields.add({"velocity", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
    return make_dataset(Mesh(g), std::move(fields));
  };
  p.center = Vec3(0, 0, 0);
  const DatasetPtr wide = time_surface(pull, {}, p, context);
  CHECK(area(wide) == doctest::Approx(0.24 * std::exp(0.5)).epsilon(1e-3));
  check_manifold(wide);
}

TEST_CASE("unsteady surfaces: the same bytes for any number of threads; one step and curves outside are refused") {
  Context context;
  const auto p = along_z<StreakSurfaceParams>();
  set_thread_count(1);
  const DatasetPtr one = streak_surface(oscillating(), {}, p, context);
  set_thread_count(8);
  const DatasetPtr many = streak_surface(oscillating(), {}, p, context);
  set_thread_count(0);
  const Array &a = one->as<SurfaceMesh>()->points.xyz, &b = many->as<SurfaceMesh>()->points.xyz;
  REQUIRE(a.bytes() == b.bytes());
  CHECK(std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
  auto far = along_z<PathSurfaceParams>();
  far.curve.from = Vec3(9, 9, 9), far.curve.to = Vec3(9, 9, 10);
  CHECK(test::error_of([&] { path_surface(oscillating(), {}, far, context); }).find("seeds") != std::string::npos);
  Series single = oscillating();
  single.times.resize(1);
  CHECK(test::error_of([&] { streak_surface(single, {}, p, context); }).find("step") != std::string::npos);
}

TEST_CASE("unsteady surfaces: without a curve or a surface they begin across the flow, in flat meshes along them") {
  Context context;
  std::string log;
  context.on_log = [&](LogLevel, std::string_view text) { log += text; };
  PathSurfaceParams path;
  path.time = 1;
  const Box3 swept = path_surface(oscillating(), {}, path, context)->bounds();
  CHECK(log.find("path_surface: seeds: a line across the flow, from=") != std::string::npos);
  CHECK(swept.size().z == doctest::Approx(4 * std::sqrt(3.0) / 4).epsilon(0.02));  // an eighth of the diagonal to both sides
  CHECK(swept.lo.x == doctest::Approx(0));
  CHECK(swept.hi.x == doctest::Approx(U).epsilon(1e-4));
  StreakSurfaceParams streak;
  streak.time = 1;
  CHECK(streak_surface(oscillating(), {}, streak, context)->bounds().size().z > 1.5);
  TimeSurfaceParams patch;
  patch.time = 0.5;
  const DatasetPtr carried = time_surface(oscillating(), {}, patch, context);
  CHECK(area(carried) == doctest::Approx(3).epsilon(0.02));
  const Vec3 centre = carried->bounds().center();
  CHECK(length(centre - moved({}, 0, 0.5)) < 2e-2);
  // Flat: the curve lies in the plane, the rectangle too.
  Series flat;
  flat.times = {0, 1};
  flat.load = [](size_t) -> Data {
    UniformGrid g;
    g.dims = {21, 21, 1};
    g.spacing = {0.1, 0.1, 1};
    return test::velocity_on(g, [](Vec3) { return Vec3(0.2, 0, 0); });
  };
  const DatasetPtr sheet = path_surface(flat, {}, {}, context);
  CHECK(sheet->bounds().size().y > 0.6);
  CHECK(area(sheet) == doctest::Approx(0.2 * sheet->bounds().size().y).epsilon(1e-3));
  CHECK(area(time_surface(flat, {}, {}, context)) == doctest::Approx(0.5).epsilon(0.02));
  flat.load = [](size_t) -> Data { return test::cube_flow(3, -2, 2, [](Vec3) { return Vec3(); }); };
  CHECK(test::error_of([&] { path_surface(flat, {}, {}, context); }).find("there is no flow") != std::string::npos);
  CHECK(test::error_of([&] { time_surface(flat, {}, {}, context); }).find("there is no flow") != std::string::npos);
  patch.size = {1, 1};
  CHECK(test::error_of([&] { time_surface(oscillating(), {}, patch, context); }).find("center=x,y,z") != std::string::npos);
}
