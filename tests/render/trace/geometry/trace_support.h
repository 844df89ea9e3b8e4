// SPDX-License-Identifier: Apache-2.0
// Meshes and rays for the tests of the path tracer's geometry.
#pragma once
#include <cmath>
#include <numbers>
#include <vector>

#include "base/context.h"
#include "base/random.h"
#include "render/trace/geometry/triangles.h"
#include "support/test.h"

namespace sg::trace::test {

struct TestMesh {
  std::vector<float> xyz;
  std::vector<uint32_t> corners;

  TriangleInput input() const { return {xyz.data(), corners.data(), corners.size() / 3, {}, 1}; }
  Triangles tree() const {
    Context context;
    return Triangles(input(), context);
  }
};

inline float uniform(uint64_t seed, uint64_t i, double lo = -1, double hi = 1) { return float(lo + (hi - lo) * random_unit(seed, i)); }

/// n triangles of about `size` anywhere in [-1,1]^3.
inline TestMesh soup(size_t n, double size, uint64_t seed) {
  TestMesh m;
  for (size_t i = 0; i < n; ++i) {
    const float middle[3] = {uniform(seed, 12 * i), uniform(seed, 12 * i + 1), uniform(seed, 12 * i + 2)};
    for (uint64_t k = 0; k < 3; ++k) {
      for (uint64_t a = 0; a < 3; ++a) m.xyz.push_back(middle[a] + uniform(seed, 12 * i + 3 + 3 * k + a, -size, size));
      m.corners.push_back(uint32_t(3 * i + k));
    }
  }
  return m;
}

/// A closed ball of radius 1, 2 n (2 n - 2) triangles whose corners are shared; poles on the z axis.
inline TestMesh ball_mesh(int n) {
  TestMesh m;
  auto add = [&](double theta, double phi) {
    for (const double v : {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)}) m.xyz.push_back(float(v));
  };
  const int around = 2 * n;
  add(0, 0);
  for (int j = 1; j < n; ++j)
    for (int i = 0; i < around; ++i) add(std::numbers::pi * j / n, 2 * std::numbers::pi * i / around);
  add(std::numbers::pi, 0);
  const auto last = uint32_t(m.xyz.size() / 3 - 1);
  auto at = [&](int j, int i) { return j == 0 ? 0 : j == n ? last : uint32_t(1 + (j - 1) * around + i % around); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < around; ++i) {
      if (j > 0) m.corners.insert(m.corners.end(), {at(j, i), at(j + 1, i), at(j, i + 1)});
      if (j + 1 < n) m.corners.insert(m.corners.end(), {at(j, i + 1), at(j + 1, i), at(j + 1, i + 1)});
    }
  return m;
}

/// The cube [-a,a]^3, twelve triangles.
inline TestMesh cube_mesh(float a) {
  TestMesh m;
  for (int i = 0; i < 8; ++i)
    for (int k = 0; k < 3; ++k) m.xyz.push_back(i >> k & 1 ? a : -a);
  m.corners = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return m;
}

/// Uniform over directions.
inline Vec3f any_direction(uint64_t seed, uint64_t i) {
  const double z = 2 * random_unit(seed, 2 * i) - 1, phi = 2 * std::numbers::pi * random_unit(seed, 2 * i + 1), r = std::sqrt(1 - z * z);
  return normalize(Vec3f(float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)));
}

inline Vec3f any_place(uint64_t seed, uint64_t i, double reach) {
  return {uniform(seed, 3 * i, -reach, reach), uniform(seed, 3 * i + 1, -reach, reach), uniform(seed, 3 * i + 2, -reach, reach)};
}

/// Uniform over the lines that meet the ball of that radius about the origin; starts outside it.
inline Ray any_line(uint64_t seed, uint64_t i, double radius) {
  const Vec3 d(any_direction(seed, 2 * i));
  const Vec3 x = normalize(cross(d, std::abs(d.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0))), y = cross(d, x);
  const double r = radius * std::sqrt(random_unit(seed + 1, 2 * i)), phi = 2 * std::numbers::pi * random_unit(seed + 1, 2 * i + 1);
  return {Vec3f(x * (r * std::cos(phi)) + y * (r * std::sin(phi)) - d * (2 * radius)), Vec3f(d)};
}

}  // namespace sg::trace::test
