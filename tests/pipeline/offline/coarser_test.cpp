// SPDX-License-Identifier: Apache-2.0
// What pages make coarser to keep within their budget.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "pipeline/offline/pack/flat_surface.h"
#include "pipeline/offline/pack/page_lattice.h"
#include "support/test.h"

using namespace sg;
using namespace sg::offline;

namespace {

// A unit sphere of n times 2n quads, cut in two each.
FlatSurface globe(int n) {
  FlatSurface s;
  const auto add = [&](double polar, double around) {
    for (const double x : {std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar)})
      s.xyz.push_back(float(x)), s.normals.push_back(float(x));
    s.colors.positions.push_back(0.5 + 0.5 * std::cos(polar));
  };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j < 2 * n; ++j) add(std::numbers::pi * i / n, std::numbers::pi * j / n);
  const auto at = [&](int i, int j) { return uint32_t(i * 2 * n + j % (2 * n)); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j)
      for (const uint32_t p : {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)})
        s.triangles.push_back(p);
  return s;
}

}  // namespace

TEST_CASE("clustered surfaces: points stay within a part of the box, normals and values follow") {
  const FlatSurface fine = globe(60);
  for (const int parts : {16, 32}) {
    const FlatSurface s = clustered(fine, parts, false);
    CHECK(s.triangles.size() < fine.triangles.size() / (parts == 16 ? 4 : 1));
    REQUIRE(s.colors.positions.size() == s.points());
    REQUIRE(s.normals.size() == s.xyz.size());
    double off = 0, value = 0, normal = 0;
    for (size_t i = 0; i < s.points(); ++i) {
      const Vec3f p{s.xyz[3 * i], s.xyz[3 * i + 1], s.xyz[3 * i + 2]}, n{s.normals[3 * i], s.normals[3 * i + 1], s.normals[3 * i + 2]};
      off = std::max(off, std::abs(double(length(p)) - 1));
      value = std::max(value, std::abs(s.colors.positions[i] - (0.5 + 0.5 * double(p.z))));
      if (dot(n, n) > 0) normal = std::max(normal, double(length(n - normalize(p))));
    }
    const double edge = 2.0 / parts;
    CHECK(off < edge * edge);  // means lie inside by the square of their spread
    CHECK(value < 1e-6);
    CHECK(normal < 4 * edge);
  }
}

TEST_CASE("clustered surfaces: a sphere stays closed: every edge has a triangle on both sides") {
  const FlatSurface s = clustered(globe(60), 25, false);
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (size_t t = 0; t < s.triangles.size(); t += 3)
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = s.triangles[t + k], b = s.triangles[t + (k + 1) % 3];
      ++edges[{std::min(a, b), std::max(a, b)}];
    }
  // An odd number of parts: the points at the poles lie in one.
  CHECK(std::all_of(edges.begin(), edges.end(), [](const auto& e) { return e.second >= 2; }));
}

TEST_CASE("clustered surfaces: labels are not blended") {
  FlatSurface fine = globe(20);
  for (double& t : fine.colors.positions) t = t < 0.5 ? 0.25 : 0.75;
  const FlatSurface s = clustered(fine, 6, true);
  for (const double t : s.colors.positions) CHECK((t == 0.25 || t == 0.75));
}

TEST_CASE("means over boxes: a linear field stays linear, its mean the same, for any ratio") {
  const std::array<size_t, 3> from{20, 15, 12};
  std::vector<float> v;
  for (size_t k = 0; k < from[2]; ++k)
    for (size_t j = 0; j < from[1]; ++j)
      for (size_t i = 0; i < from[0]; ++i) v.push_back(float(2 * double(i) - 3 * double(j) + 0.5 * double(k)));
  for (const std::array<size_t, 3> to : {std::array<size_t, 3>{10, 5, 4}, {13, 11, 7}, {20, 15, 12}}) {
    const std::vector<float> m = box_means(v, from, to, false);
    REQUIRE(m.size() == to[0] * to[1] * to[2]);
    double sum = 0, worst = 0;
    const auto middle = [&](size_t i, size_t a) { return (double(i) + 0.5) * double(from[a]) / double(to[a]) - 0.5; };
    for (size_t k = 0, n = 0; k < to[2]; ++k)
      for (size_t j = 0; j < to[1]; ++j)
        for (size_t i = 0; i < to[0]; ++i, ++n) {
          sum += double(m[n]);
          worst = std::max(worst, std::abs(double(m[n]) - (2 * middle(i, 0) - 3 * middle(j, 1) + 0.5 * middle(k, 2))));
        }
    CHECK(sum / double(m.size()) == doctest::Approx(2 * 9.5 - 3 * 7 + 0.5 * 5.5).epsilon(1e-4));
    CHECK(worst < 0.9);  // parts of samples at the ends of a box pull its mean aside
  }
}

TEST_CASE("means over boxes: what has no value takes no part, and few values make none") {
  const std::vector<float> v{1, NAN, NAN, NAN, 3, 3, NAN, 3};
  const std::vector<float> m = box_means(v, {4, 1, 2}, {2, 1, 1}, false);
  CHECK(m[0] == doctest::Approx(7.0 / 3));
  CHECK(std::isnan(m[1]));
  const std::vector<float> nearest = box_means({0, 7, 0, 9}, {4, 1, 1}, {2, 1, 1}, true);
  CHECK((nearest[0] == 7 && nearest[1] == 9));
}
