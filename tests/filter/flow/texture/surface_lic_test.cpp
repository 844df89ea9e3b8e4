// SPDX-License-Identifier: Apache-2.0
// LIC in object space: statistics (F9), circles, latitudes, seams, and what is refused.
#include <cmath>
#include <functional>
#include <numbers>

#include "base/parallel.h"
#include "base/random.h"
#include "filter/flow/texture/surface/surface_lic.h"
#include "filter/flow/texture/surface/surface_walk.h"
#include "support/test.h"

using namespace sg;

namespace {

using std::numbers::pi;
using Flow = std::function<Vec3(Vec3)>;

DatasetPtr triangles(const std::vector<Vec3>& points, std::vector<int32_t> corners, const Flow& flow, Association on = Association::point) {
  SurfaceMesh m;
  std::vector<double> xyz, v;
  for (const Vec3& p : points)
    for (int c = 0; c < 3; ++c) xyz.push_back(p[c]);
  if (on == Association::point) {
    for (const Vec3& p : points)
      for (int c = 0; c < 3; ++c) v.push_back(flow(p)[c]);
  } else {
    for (size_t t = 0; t < corners.size() / 3; ++t)
      for (int c = 0; c < 3; ++c)
        v.push_back(
            flow((points[size_t(corners[3 * t])] + points[size_t(corners[3 * t + 1])] + points[size_t(corners[3 * t + 2])]) / 3.0)[c]);
  }
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.polygons.connectivity = Array::from_vector(std::move(corners)), m.polygons.fixed = 3;
  FieldSet f;
  f.add({"v", on, Array::from_vector(std::move(v), 3), "", Role::vectors});
  return make_dataset(m, f);
}

/// n x n squares of side 1 from the origin, each cut along one diagonal; `random`: either, and inner points moved.
DatasetPtr plane(int n, const Flow& flow, bool random = false, bool split = false) {
  std::vector<Vec3> p;
  std::vector<int32_t> t;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      Vec3 q{double(i), double(j), 0};
      if (random && i > 0 && j > 0 && i < n && j < n)
        for (int c = 0; c < 2; ++c) q[c] += 0.5 * (random_unit(5, uint64_t((j * (n + 1) + i) * 2 + c)) - 0.5);
      p.push_back(q);
    }
  // split: the right half has points of its own along the middle column.
  const int first = int(p.size());
  if (split)
    for (int j = 0; j <= n; ++j) p.push_back(p[size_t(j * (n + 1) + n / 2)]);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto at = [&](int a, int b) { return split && i >= n / 2 && a == n / 2 ? first + b : b * (n + 1) + a; };
      const int a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      if (random && random_unit(9, uint64_t(j * n + i)) < 0.5) t.insert(t.end(), {a, b, d, b, c, d});
      else t.insert(t.end(), {a, b, c, a, c, d});
    }
  return triangles(p, t, flow);
}

DatasetPtr globe(int n, const Flow& flow) {
  std::vector<Vec3> p;
  std::vector<int32_t> t;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i < 2 * n; ++i) {
      const double th = pi * j / n, ph = pi * i / n;
      p.push_back({std::sin(th) * std::cos(ph), std::sin(th) * std::sin(ph), std::cos(th)});
      if (j == n) continue;
      const int a = j * 2 * n + i, b = j * 2 * n + (i + 1) % (2 * n);
      t.insert(t.end(), {a, a + 2 * n, b + 2 * n, a, b + 2 * n, b});
    }
  return triangles(p, t, flow);
}

struct Stats {
  double mean = 0, variance = 0;
};
template <class At>
Stats stats(int n, int margin, At at) {
  Stats s;
  double k = 0;
  for (int j = margin; j <= n - margin; ++j)
    for (int i = margin; i <= n - margin; ++i, ++k) s.mean += at(i, j), s.variance += at(i, j) * at(i, j);
  s.mean /= k, s.variance = s.variance / k - s.mean * s.mean;
  return s;
}

SurfaceLicParams plain(int steps) {
  SurfaceLicParams p;
  p.density = 0, p.steps = steps, p.step = 1, p.kernel = LineFade::box, p.stretch = false;
  return p;
}

DatasetPtr run(const DatasetPtr& d, const SurfaceLicParams& p) {
  Context context;
  return surface_lic(d, p, context);
}
View<float> lic_of(const DatasetPtr& d) { return d->fields().require("lic", Association::point).array.view<float>(); }

}  // namespace

TEST_CASE("surface_lic: on a plane the variance is 1/L, the correlation 1 - k/L along the flow and 0 across (F9)") {
  const int n = 512, steps = 10, L = 2 * steps + 1;
  for (const bool along_y : {false, true}) {
    const DatasetPtr d = plane(n, [&](Vec3) { return along_y ? Vec3{0, 1, 0} : Vec3{1, 0, 0}; });
    const DatasetPtr r = run(d, plain(steps));
    const View<float> v = lic_of(r);
    const auto at = [&](int i, int j) { return double(v[size_t(j * (n + 1) + i)]); };
    const Stats s = stats(n, L, at);
    CHECK(s.mean == doctest::Approx(0.5).epsilon(0.01));
    CHECK(s.variance == doctest::Approx(1.0 / 12 / L).epsilon(0.03));
    for (const int k : {3, 7, 14, 20, 40}) {
      double along = 0, across = 0, count = 0;
      for (int j = L; j <= n - L - 40; ++j)
        for (int i = L; i <= n - L - 40; ++i, ++count) {
          const double a = at(i, j) - s.mean, x = at(i + k, j) - s.mean, y = at(i, j + k) - s.mean;
          along += a * (along_y ? y : x), across += a * (along_y ? x : y);
        }
      CHECK(along / count / s.variance == doctest::Approx(std::max(0.0, 1 - double(k) / L)).epsilon(0.03).scale(1));
      CHECK(std::abs(across / count / s.variance) < 0.03);
    }
  }
}

TEST_CASE("surface_lic: lines are straight in a constant flow and closed in one that turns, on any triangles") {
  Context context;
  const int n = 24;
  const DatasetPtr d = plane(
      n,
      [](Vec3) {
        return Vec3{0.8, 0.6, 0.4};
      },
      true);  // the part off the plane does not count
  const RefinedSurface s = refine_surface(d, 0, 1 << 20, context);
  std::vector<Vec3> v(s.points.size(), Vec3{0.8, 0.6, 0.4});
  const SurfaceWalk walk(s, v, false);
  for (const uint32_t t : {500u, 600u, 700u}) {
    SurfaceWalk::Place at = walk.start(t, s.triangles[t][1]);
    const Vec3 from = walk.position(at);
    REQUIRE(walk.advance(at, 5, -1));
    CHECK(length(walk.position(at) - (from - Vec3{0.8, 0.6, 0} * 5.0)) < 1e-9);
    REQUIRE(walk.advance(at, 5, 1));
    CHECK(length(walk.position(at) - from) < 1e-9);
  }
  // Around (12, 12): after a full turn the line is back, with an error of second order in the size of the triangles.
  double error[2];
  for (const int level : {0, 1}) {
    const RefinedSurface r = refine_surface(d, level == 0 ? 0.8 : 0.4, 1 << 20, context);
    std::vector<Vec3> turn;
    for (const Vec3& p : r.points) turn.push_back({-(p.y - 12), p.x - 12, 0});
    const SurfaceWalk round(r, turn, false);
    error[level] = 0;
    for (uint32_t t = 0; t < r.triangles.size(); t += 97) {
      SurfaceWalk::Place at = round.start(t, r.triangles[t][0]);
      const Vec3 from = round.position(at);
      const double radius = length(from - Vec3{12, 12, 0});
      if (radius < 3 || radius > 11) continue;
      REQUIRE(round.advance(at, 2 * pi * radius, 1));
      error[level] = std::max(error[level], length(round.position(at) - from));
    }
  }
  CHECK(error[0] < 0.3);
  CHECK(error[1] < 0.4 * error[0]);
}

TEST_CASE("surface_lic: edges where the flow runs in from both sides are followed, and creases crossed") {
  Context context;
  const int n = 10;
  const DatasetPtr d = plane(n, [](Vec3 p) { return Vec3{1, p.y < 5 ? 1.0 : p.y > 5 ? -1.0 : 0.0, 0}; });
  const RefinedSurface s = refine_surface(d, 0, 1 << 20, context);
  // Vectors of the triangles: towards y = 5 from both sides.
  std::vector<Vec3> v;
  for (const auto& t : s.triangles) v.push_back({1, (s.points[t[0]].y + s.points[t[1]].y + s.points[t[2]].y) / 3 < 5 ? 1.0 : -1.0, 0});
  const SurfaceWalk walk(s, v, true);
  SurfaceWalk::Place at = walk.start(2 * 22 + 1, s.triangles[2 * 22 + 1][0]);  // (2, 2)
  walk.advance(at, 5, 1);
  CHECK(walk.position(at).y == doctest::Approx(5));
  CHECK(walk.position(at).x == doctest::Approx(5 + (5 - 3 * std::sqrt(2.0))));
  CHECK_FALSE(walk.advance(at, 100, 1));  // the border
  CHECK(walk.position(at).x == doctest::Approx(10));
  // A prism of six sides: a helix of the field (tangent + z) climbs as on the plane that it unfolds to.
  std::vector<Vec3> p;
  std::vector<int32_t> corners;
  for (int k = 0; k < 6; ++k)
    for (const double z : {0.0, 20.0}) p.push_back({std::cos(k * pi / 3), std::sin(k * pi / 3), z});
  for (int k = 0; k < 6; ++k) {
    const int a = 2 * k, b = 2 * ((k + 1) % 6);
    corners.insert(corners.end(), {a, b, b + 1, a, b + 1, a + 1});
  }
  const RefinedSurface prism = refine_surface(triangles(p, corners, [](Vec3) { return Vec3{1, 0, 0}; }), 0.4, 1 << 20, context);
  std::vector<Vec3> around;
  for (const auto& t : prism.triangles) {
    const Vec3 c = (prism.points[t[0]] + prism.points[t[1]] + prism.points[t[2]]) / 3.0;
    const double side = (std::floor(std::atan2(c.y, c.x) / (pi / 3)) + 0.5) * pi / 3;
    around.push_back({-std::sin(side), std::cos(side), 0.5});
  }
  const SurfaceWalk helix(prism, around, true);
  SurfaceWalk::Place up = helix.start(0, prism.triangles[0][0]);
  const Vec3 from = helix.position(up);
  REQUIRE(helix.advance(up, 12 * std::sqrt(1.25), 1));  // twice around, each side is 1 long
  CHECK(length(helix.position(up) - (from + Vec3{0, 0, 6})) < 1e-6);
}

TEST_CASE("surface_lic: on a turning sphere the texture is constant along latitudes") {
  const DatasetPtr d = globe(40, [](Vec3 p) { return Vec3{-p.y, p.x, 0}; });
  SurfaceLicParams p = plain(400);
  p.step = 0.05;  // 20 each way: three times around the equator
  const DatasetPtr r = run(d, p);
  const View<float> v = lic_of(r);
  double within = 0, means = 0, squares = 0;
  int rows = 0;
  for (int j = 10; j <= 30; ++j, ++rows) {
    double mean = 0, square = 0;
    for (int i = 0; i < 80; ++i) mean += double(v[size_t(j * 80 + i)]) / 80, square += std::pow(double(v[size_t(j * 80 + i)]), 2) / 80;
    within += square - mean * mean, means += mean, squares += mean * mean;
  }
  const double between = squares / rows - std::pow(means / rows, 2);
  CHECK(std::sqrt(within / rows) < 0.3 * std::sqrt(between));
}

TEST_CASE("surface_lic: other triangles and refinement change the noise, not its statistics; seams do not show") {
  const int n = 160, L = 21;
  const Flow flow = [](Vec3) { return Vec3{1, 0, 0}; };
  const auto spread = [&](const DatasetPtr& d) {
    SurfaceLicParams p;
    p.steps = 20, p.step = 0.5, p.density = 0, p.kernel = LineFade::box;
    const DatasetPtr r = run(d, p);
    const View<float> v = lic_of(r);
    return stats(n, L, [&](int i, int j) { return double(v[size_t(j * (n + 1) + i)]); });
  };
  const Stats a = spread(plane(n, flow)), b = spread(plane(n, flow, true));
  CHECK(a.mean == doctest::Approx(b.mean).epsilon(0.04));
  CHECK(a.variance == doctest::Approx(b.variance).epsilon(0.3));
  CHECK(a.variance > 0.03);  // stretched over 0 to 1

  const DatasetPtr whole = run(plane(n, flow), plain(10)), split = run(plane(n, flow, false, true), plain(10));
  const View<float> u = lic_of(whole), w = lic_of(split);
  size_t same = 0;
  for (size_t i = 0; i < whole->point_count(); ++i) same += u[i] == w[i];
  CHECK(same == whole->point_count());
  for (int j = 0; j <= n; ++j) CHECK(w[whole->point_count() + size_t(j)] == w[size_t(j * (n + 1) + n / 2)]);
}

TEST_CASE("surface_lic: refined meshes have short edges, no gaps, the same area and linear fields") {
  Context context;
  const DatasetPtr d = plane(
      4, [](Vec3 p) { return p; }, true);
  const RefinedSurface r = refine_surface(d, 0.3, 1 << 20, context);
  double area = 0, longest = 0;
  size_t open = 0;
  for (size_t t = 0; t < r.triangles.size(); ++t) {
    const auto& c = r.triangles[t];
    area += 0.5 * length(cross(r.points[c[1]] - r.points[c[0]], r.points[c[2]] - r.points[c[0]]));
    for (size_t k = 0; k < 3; ++k)
      longest = std::max(longest, length(r.points[c[k]] - r.points[c[(k + 1) % 3]])), open += r.across[t][k] < 0;
  }
  CHECK(area == doctest::Approx(16));
  CHECK(longest <= 0.3);
  CHECK(open == 4 * 16);  // sides of 4, split into sixteenths
  const View<double> v = r.dataset->fields().require("v").array.view<double>();
  for (size_t i = 0; i < r.points.size(); ++i) CHECK(std::abs(v(i, 0) - r.points[i].x) < 1e-12);
}

TEST_CASE("surface_lic: 1 and 8 threads give the same bytes") {
  const DatasetPtr d = globe(12, [](Vec3 p) { return Vec3{std::sin(3 * p.z), p.x, p.y}; });
  SurfaceLicParams p;
  p.density = 80;
  set_thread_count(1);
  const DatasetPtr a = run(d, p);
  set_thread_count(8);
  const DatasetPtr b = run(d, p);
  set_thread_count(0);
  const View<float> u = lic_of(a), w = lic_of(b);
  REQUIRE(u.count == w.count);
  CHECK(u.count > 5000);
  size_t different = 0;
  for (size_t i = 0; i < u.count; ++i) different += u[i] != w[i] || !(u[i] >= 0 && u[i] <= 1);
  CHECK(different == 0);
}

TEST_CASE("surface_lic: zero, NaN and cells without vectors are neutral, and what cannot be followed is refused") {
  const DatasetPtr zero = run(plane(8, [](Vec3) { return Vec3{}; }), plain(5));
  for (size_t i = 0; i < zero->point_count(); ++i) CHECK(lic_of(zero)[i] == 0.5f);
  const DatasetPtr holes = run(plane(8, [](Vec3 p) { return p.x < 4 ? Vec3{NAN, NAN, NAN} : Vec3{1, 0, 0}; }), plain(5));
  size_t neutral = 0;
  for (size_t i = 0; i < holes->point_count(); ++i) neutral += lic_of(holes)[i] == 0.5f;
  CHECK(neutral >= 4 * 9);
  CHECK(neutral < 6 * 9);
  CHECK(holes->fields()[0].name == "lic");

  DatasetParts parts = plane(2, [](Vec3) { return Vec3{1, 0, 0}; })->parts();
  SurfaceLicParams p;
  p.field = {"s"};
  parts.fields.add({"s", Association::point, Array::from_vector<float>(std::vector<float>(9, 1.0f)), ""});
  CHECK_THROWS_WITH_AS(run(make_dataset(parts), p), doctest::Contains("component"), Error);
  p.field = {"vv"};
  CHECK_THROWS_AS(run(make_dataset(parts), p), Error);
  parts.fields = {};
  CHECK_THROWS_AS(run(make_dataset(parts), {}), Error);
  p = {};
  p.density = 1e5;
  CHECK_THROWS_WITH_AS(run(plane(4, [](Vec3) { return Vec3{1, 0, 0}; }), p), doctest::Contains("density"), Error);
  SurfaceMesh lines;
  lines.points.xyz = Array::from_vector<float>({0, 0, 0, 1, 0, 0}, 3);
  lines.lines.connectivity = Array::from_vector<int32_t>({0, 1}), lines.lines.fixed = 2;
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector<float>({1, 0, 0, 1, 0, 0}, 3), "", Role::vectors});
  CHECK_THROWS_WITH_AS(run(make_dataset(lines, f), {}), doctest::Contains("no faces"), Error);
}
