// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/bodies/spring_mesh.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "simulate/particles/meshes.h"
#include "support/test.h"

using namespace sg;

namespace {

// A line of n points below each other, 1 apart.
DatasetPtr string_of(size_t n) {
  std::vector<double> xyz;
  std::vector<int64_t> ids;
  for (size_t i = 0; i < n; ++i) {
    for (const double v : {0.0, 0.0, -double(i)}) xyz.push_back(v);
    ids.push_back(int64_t(i));
  }
  SurfaceMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.lines.connectivity = Array::from_vector(ids), mesh.lines.fixed = int(n);
  return make_dataset(std::move(mesh));
}

std::string exact(const DatasetPtr& d) {
  const Array& xyz = d->as<SurfaceMesh>()->points.xyz;
  return {reinterpret_cast<const char*>(xyz.raw()), xyz.bytes()};
}

// Whether the segment goes through the triangle.
bool pierces(Vec3 p, Vec3 q, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 n = cross(b - a, c - a);
  const double from = dot(p - a, n), to = dot(q - a, n);
  if (from * to >= 0) return false;
  const Vec3 at = p + (from / (from - to)) * (q - p);
  return dot(cross(b - a, at - a), n) > 0 && dot(cross(c - b, at - b), n) > 0 && dot(cross(a - c, at - c), n) > 0;
}

// How many edges of one mesh of triangles go through faces of the other.
int crossings(const DatasetPtr& one, const DatasetPtr& other) {
  int count = 0;
  for (const auto& [e, f] : {std::pair{one, other}, std::pair{other, one}}) {
    const auto &m = *e->as<SurfaceMesh>(), &n = *f->as<SurfaceMesh>();
    const CellsView edges = cells_view(m.polygons), faces = cells_view(n.polygons);
    for (size_t i = 0; i < edges.count; ++i)
      for (size_t k = 0; k < 3; ++k)
        for (size_t j = 0; j < faces.count; ++j) {
          const auto corner = [&](size_t c) { return n.points.at(size_t(faces.point(j, c))); };
          const auto end = [&](size_t c) { return m.points.at(size_t(edges.point(i, c % 3))); };
          count += pierces(end(k), end(k + 1), corner(0), corner(1), corner(2));
        }
  }
  return count;
}

// n x n points of [-1, 1]^2 at a height, in triangles.
DatasetPtr cloth_of(int n, double z) {
  std::vector<Vec3> points;
  std::vector<int64_t> ids;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      points.emplace_back(-1 + 2.0 * i / (n - 1), -1 + 2.0 * j / (n - 1), z);
      if (i + 1 == n || j + 1 == n) continue;
      for (const int k : {0, 1, n, 1, n + 1, n}) ids.push_back(i + n * j + k);
    }
  return test::triangles(points, ids);
}

// A needle whose point is at (x, y, 0), and a blade along x, wider than the cloth, whose edge is at z = 0.
DatasetPtr needle_at(double x, double y) {
  const double r = 0.05;
  return test::triangles({{x, y, 0}, {x - r, y - r, -3}, {x + r, y - r, -3}, {x + r, y + r, -3}, {x - r, y + r, -3}},
                         {0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 1, 1, 3, 2, 1, 4, 3});
}
DatasetPtr blade() {
  return test::triangles({{-4, 0.07, 0}, {4, 0.07, 0}, {-4, 0.02, -3}, {4, 0.02, -3}, {-4, 0.12, -3}, {4, 0.12, -3}},
                         {0, 1, 2, 1, 3, 2, 0, 4, 1, 1, 4, 5, 2, 3, 4, 3, 5, 4, 0, 2, 4, 1, 5, 3});
}

}  // namespace

TEST_CASE("spring_mesh: coarse cloth does not go through a needle or a blade that meets none of its points") {
  Context context;
  SpringMeshParams p;
  p.mass = 0.05, p.stiffness = 15, p.damping = 0.2, p.restitution = 0.2, p.friction = 0.3, p.frame = 0.05, p.step = 5e-3;
  const DatasetPtr cloth = cloth_of(3, 0.2);
  for (const bool held : {true, false})
    for (const DatasetPtr& sharp : {needle_at(0.31, 0.24), needle_at(0.5, 0.003), blade()}) {
      p.hold = held ? std::vector<double>{0, 2, 6, 8} : std::vector<double>{};
      CHECK(crossings(cloth, sharp) == 0);
      double lowest = 0, lowest_alone = 0;
      for (p.time = p.frame; p.time < 1.5; p.time += p.frame) {
        const DatasetPtr d = spring_mesh({cloth, sharp}, p, context);
        CAPTURE(held);
        CAPTURE(p.time);
        CAPTURE(d->bounds().lo.z);
        CHECK(crossings(d, sharp) == 0);
        lowest = std::min(lowest, d->bounds().lo.z);
      }
      CHECK(lowest < (held ? 0.1 : -0.3));  // it did fall
      // Without what is sharp the held cloth sags below its point.
      for (p.time = p.frame; held && p.time < 1.5; p.time += p.frame)
        lowest_alone = std::min(lowest_alone, spring_mesh({cloth}, p, context)->as<SurfaceMesh>()->points.at(4).z);
      if (held) CHECK(lowest_alone < -0.1);
    }
}

TEST_CASE("spring_mesh: a face that falls fast on a needle bounces with its restitution; bytes for any number of threads") {
  // One triangle, whose middle meets the needle: no torque.
  Context context;
  SpringMeshParams p;
  p.mass = 1, p.stiffness = 1e-3, p.damping = 0, p.restitution = 0.5, p.frame = 0.1, p.step = 1e-3;
  const DatasetPtr face = test::triangles({{1, 0, 1}, {-0.5, 0.8, 1}, {-0.5, -0.8, 1}}, {0, 1, 2}), needle = needle_at(0, 0);
  const double fall = std::sqrt(2 / 9.81), up = 0.5 * 9.81 * fall;
  p.time = fall + up / 9.81;  // highest again: a quarter as high
  p.frame = p.time / 8;
  std::string first;
  for (const int threads : {1, 3}) {
    set_thread_count(threads);
    SpringMeshParams other;
    spring_mesh({string_of(2)}, other, context);
    const DatasetPtr d = spring_mesh({face, needle}, p, context);
    for (size_t i = 0; i < 3; ++i) CHECK(d->as<SurfaceMesh>()->points.at(i).z == doctest::Approx(0.25).epsilon(0.03));
    const std::string bytes = exact(d);
    if (first.empty()) first = bytes;
    CHECK(bytes == first);
  }
  set_thread_count(0);
}

TEST_CASE("spring_mesh: a hanging chain comes to rest where each spring bears what is below it; a mass swings with sqrt(k/m)") {
  Context context;
  SpringMeshParams p;
  p.hold = {0}, p.mass = 0.5, p.stiffness = 100, p.damping = 10, p.integrator = Integrator::backward_euler, p.frame = 0.5, p.step = 0.05,
  p.time = 60;
  const DatasetPtr d = spring_mesh({string_of(4)}, p, context);
  double z = 0;
  for (size_t i = 1; i < 4; ++i) {
    z -= 1 + double(4 - i) * 0.5 * 9.81 / 100;
    CHECK(d->as<SurfaceMesh>()->points.at(i).z == doctest::Approx(z).epsilon(1e-6));
  }
  SpringMeshParams q;
  q.hold = {0}, q.mass = 0.5, q.stiffness = 100, q.damping = 0, q.frame = 0.04, q.step = 1e-3, q.time = 0.4;
  const DatasetPtr e = spring_mesh({string_of(2)}, q, context);
  const double w = std::sqrt(200), sag = 0.5 * 9.81 / 100;
  CHECK(e->as<SurfaceMesh>()->points.at(1).z == doctest::Approx(-1 - sag * (1 - std::cos(w * 0.4))).epsilon(1e-4));
}

TEST_CASE("spring_mesh: cloth falls on a ball and stays outside of it") {
  std::vector<Vec3> points;
  std::vector<int64_t> ids;
  const int n = 13;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      points.emplace_back(-1.5 + 3.0 * i / (n - 1), -1.5 + 3.0 * j / (n - 1), 1.2);
      if (i + 1 == n || j + 1 == n) continue;
      for (const int k : {0, 1, n, 1, n + 1, n}) ids.push_back(i + n * j + k);
    }
  Context context;
  SpringMeshParams p;
  p.mass = 0.01, p.stiffness = 30, p.damping = 0.05, p.friction = 0.5, p.restitution = 0, p.time = 0.6, p.step = 2e-3;
  const DatasetPtr d = spring_mesh({test::triangles(points, ids), test::ball(2)}, p, context);
  const Points& at = d->as<SurfaceMesh>()->points;
  double lowest = 0;
  for (size_t i = 0; i < at.count(); ++i) {
    CHECK(length(at.at(i)) > 0.9);  // the ball's triangles lie a little within radius 1
    lowest = std::min(lowest, at.at(i).z);
  }
  CHECK(lowest < 0);
  CHECK(at.at(size_t(n * n / 2)).z > 0.9);
}

TEST_CASE("spring_mesh: what cannot be is said") {
  Context context;
  SpringMeshParams p;
  const auto refused = [&](const DatasetPtr& d) { return test::error_of([&] { spring_mesh({d}, p, context); }); };
  p.hold = {7};
  CHECK(test::contains(refused(string_of(3)), "there is no point 7"));
  p.hold = {}, p.step = HUGE_VAL;
  CHECK(test::contains(refused(string_of(3)), "not finite"));
  p.step = 0.04, p.stiffness = 1e9, p.integrator = Integrator::forward_euler, p.time = 10, p.hold = {0};
  CHECK(test::contains(refused(string_of(3)), "grew beyond all numbers in frame"));
}
