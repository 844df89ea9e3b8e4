// SPDX-License-Identifier: Apache-2.0
#include "base/random.h"
#include "filter/flow/topology/topology_support.h"
#include "filter/flow/topology/zeros/winding.h"
#include "filter/surface/surface_shapes.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test::topology;
using namespace sg::test::shapes;

TEST_CASE("winding: circles around the classes of the plane count 1, around saddles -1") {
  auto about = [](auto f) {
    std::vector<Vec2> v;
    for (int i = 0; i < 16; ++i) v.push_back(f(std::cos(i * pi / 8), std::sin(i * pi / 8)));
    return winding_index(v);
  };
  CHECK(about([](double x, double y) { return Vec2{x, y}; }) == 1);
  CHECK(about([](double x, double y) { return Vec2{-y, x}; }) == 1);
  CHECK(about([](double x, double y) { return Vec2{x, -y}; }) == -1);
  CHECK(about([](double x, double y) { return Vec2{x * x - y * y, 2 * x * y}; }) == 2);
  CHECK(about([](double x, double) { return Vec2{2 + x, 1}; }) == 0);
  CHECK(about([](double, double) { return Vec2{0, 0}; }) == std::nullopt);
}

TEST_CASE("winding: the zeros of bilinear cells sum to the turning around the cell") {
  int sums[3] = {};
  for (uint64_t s = 0; s < 500; ++s) {
    Vec2 v[4];
    for (uint64_t c = 0; c < 4; ++c) v[c] = {2 * random_unit(s, 2 * c) - 1, 2 * random_unit(s, 2 * c + 1) - 1};
    const DatasetPtr d = plane_grid(2, 2, 0, 1, 0, 1, [&](Vec3 x) {
      const Vec2 u = v[(x.x > 0.5 ? 1 : 0) + (x.y > 0.5 ? 2 : 0)];
      return Vec3(u.x, u.y, 0);
    });
    const int expected = winding_index(std::vector{v[0], v[1], v[3], v[2]}).value();
    CHECK(index_sum(zeros_of(d)) == expected);
    ++sums[expected + 1];
  }
  CHECK(sums[0] > 10);
  CHECK(sums[2] > 10);
}

TEST_CASE("winding: the zeros of trilinear cells sum to how often the velocity on the faces covers the sphere") {
  constexpr int n = 24;
  int found = 0;
  for (uint64_t s = 0; s < 60; ++s) {
    Vec3 v[8];
    for (uint64_t c = 0; c < 24; ++c) v[c / 3][int(c % 3)] = 2 * random_unit(s, c) - 1;
    auto at = [&](Vec3 u) {
      Vec3 f;
      for (int k = 0; k < 8; ++k) f += v[k] * ((k & 1 ? u.x : 1 - u.x) * (k & 2 ? u.y : 1 - u.y) * (k & 4 ? u.z : 1 - u.z));
      return f;
    };
    std::vector<Vec3> values;
    std::vector<std::array<uint32_t, 3>> triangles;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side)
        for (int j = 0; j < n; ++j)
          for (int i = 0; i < n; ++i) {
            const auto first = uint32_t(values.size());
            for (const auto& [a, b] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
              Vec3 u;
              u[axis] = side, u[(axis + 1) % 3] = double(i + a) / n, u[(axis + 2) % 3] = double(j + b) / n;
              values.push_back(at(u));
            }
            if (side) triangles.insert(triangles.end(), {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
            else triangles.insert(triangles.end(), {{first, first + 2, first + 1}, {first, first + 3, first + 2}});
          }
    const DatasetPtr d = with_velocity(sg::test::meshes::uniform_box(1, 1, 1), at);
    const CriticalPoints zeros = zeros_of(d);
    CHECK(index_sum(zeros) == covering_index(values, triangles).value());
    found += int(zeros.points.size());
  }
  CHECK(found > 10);
}

TEST_CASE("index: tangential flows on a sphere sum to 2, on a torus to 0, whatever they are (Poincare, Hopf)") {
  const struct {
    DatasetPtr mesh;
    int euler;
  } shapes[] = {{sphere(3).dataset(), 2}, {sphere(2, 3, {5, 1, 2}).dataset(), 2}, {torus(40, 20, 2, 0.7).dataset(), 0}};
  for (const auto& [mesh, euler] : shapes) {
    for (uint64_t s = 0; s < 12; ++s) {
      Vec3 k[4];
      for (uint64_t c = 0; c < 12; ++c) k[c / 3][int(c % 3)] = 2 * random_unit(s, c) - 1;
      const CriticalPoints found = zeros_of(with_velocity(mesh, [&](Vec3 x) {
        return s == 0   ? Vec3(-x.y, x.x, 0)
               : s == 1 ? Vec3(0, 0, 1)
                        : Vec3(std::sin(2 * dot(k[0], x)), std::cos(2 * dot(k[1], x)), std::sin(3 * dot(k[2], x) + 1)) + cross(k[3], x);
      }));
      CAPTURE(s);
      CHECK(found.faces_index == euler);
      CHECK(index_sum(found) == euler);
    }
  }
  // Noise has many critical points, and the same sum.
  const DatasetPtr noise = with_velocity(shapes[0].mesh, [i = uint64_t(0)](Vec3) mutable {
    i += 3;
    return Vec3(random_unit(9, i) - 0.5, random_unit(9, i + 1) - 0.5, random_unit(9, i + 2) - 0.5);
  });
  const CriticalPoints many = zeros_of(noise);
  CHECK(many.points.size() > 50);
  CHECK(index_sum(many) == 2);
}

TEST_CASE("index: the classes on a sphere are those of the flow") {
  const DatasetPtr mesh = sphere(4).dataset();
  const CriticalPoints down = zeros_of(with_velocity(mesh, [](Vec3) { return Vec3(0, 0, -1); }));
  REQUIRE(down.points.size() == 2);
  CHECK(count_of(down, CriticalType::attracting_node) == 1);
  CHECK(count_of(down, CriticalType::repelling_node) == 1);
  const CriticalPoints turning = zeros_of(with_velocity(mesh, [](Vec3 x) { return Vec3(-x.y, x.x, 0); }));
  REQUIRE(turning.points.size() == 2);
  CHECK(count_of(turning, CriticalType::centre) == 2);
  for (const auto& c : turning.points) CHECK(length(c.at - Vec3(0, 0, c.at.z > 0 ? 1 : -1)) < 1e-9);
  // Gradient of z^2 - x^2/2...: two sources, two sinks, two saddles.
  const CriticalPoints ridge = zeros_of(with_velocity(mesh, [](Vec3 x) { return Vec3(-x.x, 0.2 * x.y, 2 * x.z) + 0.01 * Vec3(1, 2, 3); }));
  CHECK(ridge.points.size() == 6);
  CHECK(count_of(ridge, CriticalType::saddle) == 2);
}
