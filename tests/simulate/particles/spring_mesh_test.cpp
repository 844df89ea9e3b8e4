// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/bodies/spring_mesh.h"

#include <cmath>
#include <numbers>

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

}  // namespace

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
