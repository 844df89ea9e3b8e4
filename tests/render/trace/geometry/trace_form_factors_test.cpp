// SPDX-License-Identifier: Apache-2.0
// What faces of a cube see of each other: rays that leave a diffuse surface arrive where they should.
#include <array>

#include "render/trace/sampling/sampler.h"
#include "render/trace/sampling/warp.h"
#include "support/statistics.h"
#include "trace_scene.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using doctest::Approx;

namespace {

/// [-0.5, 0.5]^3; face 2 a + s has the middle (s ? 0.5 : -0.5) along axis a, and two triangles.
DatasetPtr unit_cube() {
  std::vector<float> xyz;
  std::vector<int32_t> triangles;
  for (int face = 0; face < 6; ++face) {
    const int a = face / 2, b = (a + 1) % 3, c = (a + 2) % 3, first = int(xyz.size() / 3);
    for (const auto& [u, v] : {std::array{-0.5f, -0.5f}, {0.5f, -0.5f}, {0.5f, 0.5f}, {-0.5f, 0.5f}}) {
      Vec3f p;
      p[a] = face % 2 ? 0.5f : -0.5f, p[b] = u, p[c] = v;
      xyz.insert(xyz.end(), {p.x, p.y, p.z});
    }
    for (const int k : {0, 1, 2, 0, 2, 3}) triangles.push_back(first + k);
  }
  return sg::test::surface(std::move(xyz), std::move(triangles));
}

/// Shares of the light from a face that arrive at each: 1024 directions by cosine, each from 256 points spread over the face.
std::array<double, 6> arriving_from(int face, const Geometry& cube, uint64_t seed, int& lost) {
  constexpr int directions = 1024, points = 256, batch = Geometry::most_together;
  const int a = face / 2, b = (a + 1) % 3, c = (a + 2) % 3;
  const float inward = face % 2 ? -1 : 1;
  Sampler direction_of(SamplerKind::sobol, seed, directions), point_of(SamplerKind::sobol, seed + 1000, points);
  std::array<double, 6> share{};
  for (uint32_t i = 0; i < directions; ++i) {
    direction_of.start(0, 0, i);
    const Vec3f local = cosine_hemisphere(direction_of.next2());
    Vec3f direction;
    direction[a] = inward * local.z, direction[b] = local.x, direction[c] = local.y;
    for (uint32_t j = 0; j < points; j += batch) {
      Ray rays[batch];
      Hit hits[batch];
      for (uint32_t k = 0; k < batch; ++k) {
        point_of.start(i, 0, j + k);
        const Vec2f u = point_of.next2();
        Vec3f p;
        p[a] = -0.5f * inward, p[b] = u.x - 0.5f, p[c] = u.y - 0.5f;
        rays[k] = {cube.placement().traced(Vec3(p)), direction};
      }
      const uint64_t met = cube.nearest(rays, batch, hits);
      for (int k = 0; k < batch; ++k)
        if (met >> k & 1) share[hits[k].primitive / 2] += 1.0 / (directions * points);
        else ++lost;
    }
  }
  return share;
}

}  // namespace

TEST_CASE("trace: faces of a cube see the opposite one by 0.19982490 and each other one by 0.20004378") {
  // Parallel squares of side 1 at a distance of 1: 2 / pi (ln sqrt(4 / 3) + 2 sqrt 2 atan(1 / sqrt 2) - pi / 2);
  // squares with a common edge: 1 / pi (pi / 2 - sqrt 2 atan(1 / sqrt 2) + ln(3 / 4) / 4) (Howell, configurations C-11 and C-14).
  const double turn = std::sqrt(2.0) * std::atan(std::sqrt(0.5));
  const double opposite = 2 / M_PI * (0.5 * std::log(4.0 / 3) + 2 * turn - M_PI / 2);
  const double adjacent = (M_PI / 2 - turn + 0.25 * std::log(0.75)) / M_PI;
  CHECK(opposite == Approx(0.19982490).epsilon(3e-8));
  CHECK(adjacent == Approx(0.20004378).epsilon(3e-8));
  CHECK(opposite + 4 * adjacent == Approx(1).epsilon(1e-12));
  const Geometry cube = geometry_of(sg::test::item(unit_cube()));
  sg::test::Moments found_opposite, found_beside;
  int lost = 0;
  double itself = 0;
  for (uint64_t seed = 0; seed < 18; ++seed) {
    const int face = int(seed % 6);
    const auto share = arriving_from(face, cube, seed, lost);
    itself += share[size_t(face)];
    found_opposite.add(share[size_t(face ^ 1)]);
    for (int other = 0; other < 6; ++other)
      if (other / 2 != face / 2) found_beside.add(share[size_t(other)]);
  }
  CHECK(lost == 0);
  CHECK(itself == 0);
  CAPTURE(found_opposite.mean);
  CAPTURE(found_beside.mean);
  CHECK(std::abs(found_opposite.mean - opposite) <= 4 * found_opposite.standard_error());
  CHECK(std::abs(found_beside.mean - adjacent) <= 4 * found_beside.standard_error());
  CHECK(4 * found_opposite.standard_error() < 0.2 - opposite);  // a fifth for each would not do
}
