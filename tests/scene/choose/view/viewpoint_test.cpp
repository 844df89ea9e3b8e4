// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/view/viewpoint.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "support/test.h"

using namespace sg;

namespace {

// A sphere of quadrilaterals about the y axis; where `detail` looks there is a fine square before it.
SurfaceMesh sphere(std::optional<Vec3> detail) {
  constexpr int around = 24, down = 12, fine = 40;
  std::vector<float> xyz;
  std::vector<int32_t> ids;
  const auto grid = [&](int nu, int nv, auto place) {
    const int first = int(xyz.size() / 3);
    for (int v = 0; v <= nv; ++v)
      for (int u = 0; u <= nu; ++u) {
        const Vec3 p = place(double(u) / nu, double(v) / nv);
        xyz.insert(xyz.end(), {float(p.x), float(p.y), float(p.z)});
      }
    for (int v = 0; v < nv; ++v)
      for (int u = 0; u < nu; ++u) {
        const int a = first + v * (nu + 1) + u;
        ids.insert(ids.end(), {a, a + 1, a + nu + 2, a + nu + 1});
      }
  };
  grid(around, down, [](double u, double v) {
    const double a = 2 * std::numbers::pi * u, b = std::numbers::pi * v;
    return Vec3{std::sin(b) * std::cos(a), std::cos(b), std::sin(b) * std::sin(a)};
  });
  if (detail) {
    const Vec3 out = normalize(*detail), side = normalize(cross(Vec3{0, 1, 0}, out));
    grid(fine, fine, [&](double u, double v) { return out * 1.05 + side * (0.4 * (u - 0.5)) + Vec3{0, 0.4 * (v - 0.5), 0}; });
  }
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.polygons = {Array::from_vector(std::move(ids)), {}, 4};
  return m;
}

}  // namespace

TEST_CASE("viewpoint: turned in quarters about the upright axis to the side that has the detail, else left as it is") {
  const Vec3 usual{0.55, 0.42, 1.0}, up{0, 1, 0};
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double a = quarter * std::numbers::pi / 2;
    const Vec3 side{usual.x * std::cos(a) + usual.z * std::sin(a), 0, usual.z * std::cos(a) - usual.x * std::sin(a)};
    const SurfaceMesh m = sphere(side);
    const SurfaceMesh* parts[] = {&m};
    const Vec3 d = telling_direction(parts, usual, up);
    CAPTURE(quarter);
    CHECK(d.y == usual.y);
    CHECK(length(d) == doctest::Approx(length(usual)));
    CHECK(length(Vec3{d.x, 0, d.z} - side) < 1e-9);
  }
  const SurfaceMesh even = sphere({});
  const SurfaceMesh* parts[] = {&even};
  CHECK(telling_direction(parts, usual, up) == usual);
}

TEST_CASE("viewpoint: detail of another part counts, hidden detail does not, and nothing has no side") {
  const Vec3 usual{0.55, 0.42, 1.0}, up{0, 1, 0}, behind{-0.55, 0, -1.0};
  const SurfaceMesh plain = sphere({}), with = sphere(behind);
  const SurfaceMesh* both[] = {&plain, &with};
  CHECK(dot(telling_direction(both, usual, up), behind) > 0);
  SurfaceMesh hidden = sphere(behind);
  std::vector<float> xyz;
  for (size_t i = 0; i < hidden.points.count(); ++i)
    for (int a = 0; a < 3; ++a) xyz.push_back(float(0.5 * hidden.points.at(i)[a]));
  hidden.points.xyz = Array::from_vector(std::move(xyz), 3);
  const SurfaceMesh* inside[] = {&plain, &hidden};
  CHECK(telling_direction(inside, usual, up) == usual);
  const SurfaceMesh none;
  const SurfaceMesh* empty[] = {&none};
  CHECK(telling_direction(empty, usual, up) == usual);
}
