// SPDX-License-Identifier: Apache-2.0
#include "base/space/affine.h"

#include "base/random.h"
#include "base/space/matrix_distance.h"
#include "support/test.h"

using namespace sg;
using test::apart;

namespace {

Mat3 random_matrix(uint64_t n) {
  Mat3 m;
  for (int i = 0; i < 9; ++i) m.m[i / 3][i % 3] = random_unit(n, uint64_t(i)) - 0.5;
  return m;
}
Mat3 diagonal(double x, double y, double z) { return {{{x, 0, 0}, {0, y, 0}, {0, 0, z}}}; }

}  // namespace

TEST_CASE("polar decomposition: known products come apart again, mirrors and very unequal stretches too") {
  const Mat3 turn = turn_about({1, -2, 0.5}, 130), axes = turn_about({0.3, 1, 1}, 40);
  for (const Vec3 s : {Vec3{1, 1, 1}, Vec3{2, 3, 5}, Vec3{1e-3, 1, 1e3}, Vec3{1e-5, 1e-5, 1}, Vec3{1e-200, 2e-200, 3e-200}}) {
    const Mat3 stretch = axes * diagonal(s.x, s.y, s.z) * transpose(axes);
    const double size = std::max({s.x, s.y, s.z}), least = std::min({s.x, s.y, s.z});
    const Polar p = polar_decomposition(turn * stretch);
    CHECK(apart(p.rotation, turn) < 1e-15 * size / least + 1e-14);
    CHECK(apart(p.stretch, stretch) < 4e-14 * size);
    Mat3 mirrored = turn * stretch;
    for (auto& row : mirrored.m)
      for (double& v : row) v = -v;
    const Polar m = polar_decomposition(mirrored);
    CHECK(apart(m.rotation, p.rotation) == 0);
    CHECK((m.stretch.m[0][0] < 0 && m.stretch.m[1][1] < 0 && m.stretch.m[2][2] < 0));
  }
}

TEST_CASE("polar decomposition: the rotation is proper, the stretch symmetric, and no rotation lies nearer") {
  for (uint64_t n = 0; n < 200; ++n) {
    const Mat3 m = random_matrix(n);
    const Polar p = polar_decomposition(m);
    CHECK(apart(p.rotation * p.stretch, m) < 1e-14);
    CHECK(apart(transpose(p.rotation) * p.rotation, Mat3()) < 1e-14);
    CHECK(determinant(p.rotation) == doctest::Approx(1));
    CHECK(p.stretch.m[0][1] == p.stretch.m[1][0]);
    const auto distance = [&](const Mat3& r) {
      double sum = 0;
      for (int i = 0; i < 9; ++i) sum += std::pow(m.m[i / 3][i % 3] - r.m[i / 3][i % 3], 2);
      return sum;
    };
    if (determinant(m) < 0) continue;
    for (uint64_t k = 0; k < 20; ++k) {
      const Vec3 axis(random_unit(k, n + 1) - 0.5, random_unit(k, n + 2) - 0.5, random_unit(k, n + 3) - 0.5);
      CHECK(distance(turn_about(axis, 3) * p.rotation) >= distance(p.rotation));
    }
  }
  CHECK(test::contains(test::error_of([] { polar_decomposition(diagonal(1, 0, 1)); }), "singular"));
  CHECK(test::contains(test::error_of([] { polar_decomposition(diagonal(1, NAN, 1)); }), "singular"));
}

TEST_CASE("affine maps: parts put together are the map; the inverse undoes it; the image of a box holds its points") {
  for (uint64_t n = 0; n < 100; ++n) {
    const Affine a{random_matrix(n), {random_unit(n, 20), random_unit(n, 21), random_unit(n, 22)}}, b{random_matrix(n + 1000), {1, 2, 3}};
    const Affine again = put_together(take_apart(a));
    CHECK(apart(again.linear, a.linear) < 1e-14);
    CHECK(again.shift == a.shift);
    const Vec3 p{0.3, -0.2, 0.9};
    CHECK(length((a * b)(p)-a(b(p))) < 1e-14);
    CHECK(length(inverse(a)(a(p)) - p) < 1e-11);
    Box3 box;
    box.add(Vec3{-1, 0, 0}), box.add(Vec3{1, 2, 0.5});
    const Box3 image = moved(a, box);
    const Vec3 q = a(Vec3{0.5, 1.7, 0.1});
    for (int c = 0; c < 3; ++c) CHECK((q[c] >= image.lo[c] && q[c] <= image.hi[c]));
  }
  CHECK(moved(Affine(), Box3()).empty());
  CHECK_FALSE(is_invertible({diagonal(1, 1, 0), {}}));
  CHECK_FALSE(is_invertible({Mat3(), {INFINITY, 0, 0}}));
  CHECK(is_invertible({diagonal(1e-200, 1e-200, 1e-200), {}}) == false);  // its volume is no double
}

TEST_CASE("interpolation: rigid motions stay rigid, the ends are met, and blending matrices would not have done") {
  const Affine a{turn_about({0, 0, 1}, 0), {0, 0, 0}}, b{turn_about({0, 0, 1}, 170), {2, 0, 0}};
  const AffineParts pa = take_apart(a), pb = take_apart(b);
  for (int k = 0; k <= 16; ++k) {
    const double t = k / 16.0;
    const Affine m = interpolate(pa, pb, t);
    CHECK(apart(transpose(m.linear) * m.linear, Mat3()) < 1e-14);
    CHECK(apart(m.linear, turn_about({0, 0, 1}, 170 * t)) < 1e-14);
    CHECK(length(m.shift - Vec3(2 * t, 0, 0)) < 1e-15);
  }
  for (uint64_t n = 0; n < 50; ++n) {
    Affine x{random_matrix(n), {1, 0, 0}}, y{random_matrix(n + 500), {0, 1, 0}};
    CHECK(apart(interpolate(take_apart(x), take_apart(y), 0).linear, x.linear) < 1e-14);
    CHECK(apart(interpolate(take_apart(x), take_apart(y), 1).linear, y.linear) < 1e-14);
  }
  // Half way by the mean of the matrices, a turn by 170 degrees would have shrunk to a tenth.
  Mat3 mean;
  for (int i = 0; i < 9; ++i) mean.m[i / 3][i % 3] = 0.5 * (a.linear.m[i / 3][i % 3] + b.linear.m[i / 3][i % 3]);
  CHECK(length(mean * Vec3(1, 0, 0)) < 0.1);
}

TEST_CASE("interpolation: an unequal scale grows linearly along its own axes while it turns") {
  const Affine a{diagonal(1, 1, 1), {}}, b{turn_about({0, 0, 1}, 90) * diagonal(3, 1, 1), {}};
  const Affine half = interpolate(take_apart(a), take_apart(b), 0.5);
  CHECK(apart(half.linear, turn_about({0, 0, 1}, 45) * diagonal(2, 1, 1)) < 1e-14);
}
