// SPDX-License-Identifier: Apache-2.0
#include "base/vec.h"

#include "base/random.h"
#include "support/test.h"

using namespace sg;

namespace {
Mat3 random_matrix3(uint64_t seed) {
  Mat3 a;
  for (int i = 0; i < 9; ++i) a.m[i / 3][i % 3] = random_unit(seed, uint64_t(i)) - 0.5;
  return a;
}
}  // namespace

TEST_CASE("vectors: cross is orthogonal to both and follows the right hand") {
  CHECK(cross(Vec3(1, 0, 0), Vec3(0, 1, 0)) == Vec3(0, 0, 1));
  for (uint64_t i = 0; i < 100; ++i) {
    const Vec3 a(random_unit(i, 0), random_unit(i, 1), random_unit(i, 2)), b(random_unit(i, 3), random_unit(i, 4), random_unit(i, 5));
    const Vec3 c = cross(a, b);
    CHECK(std::abs(dot(a, c)) < 1e-15);
    CHECK(std::abs(dot(b, c)) < 1e-15);
    CHECK(dot(c, c) == doctest::Approx(dot(a, a) * dot(b, b) - dot(a, b) * dot(a, b)));  // Lagrange's identity
  }
  CHECK(length(Vec3(3, 4, 12)) == 13);
  CHECK(normalize(Vec3(0, 0, 0)) == Vec3(0, 0, 0));
  CHECK(length(normalize(Vec3(1e-200, 0, 0))) >= 0);
  CHECK(lerp(Vec3(0, 0, 0), Vec3(2, 4, 6), 0.5) == Vec3(1, 2, 3));
}

TEST_CASE("matrices: a matrix times its inverse is the unit matrix, 3x3 and 4x4") {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const Mat3 a = random_matrix3(seed);
    if (std::abs(determinant(a)) < 1e-3) continue;
    const Mat3 r = a * inverse(a);
    Mat4 b;
    for (int i = 0; i < 16; ++i) b.m[i / 4][i % 4] = random_unit(seed + 1000, uint64_t(i)) + (i % 5 == 0);
    const Mat4 q = b * inverse(b);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        if (i < 3 && j < 3) CHECK(std::abs(r.m[i][j] - (i == j)) < 1e-11);
        CHECK(std::abs(q.m[i][j] - (i == j)) < 1e-11);
      }
  }
  CHECK_THROWS_AS(inverse(Mat3{{{1, 2, 3}, {2, 4, 6}, {0, 0, 1}}}), Error);
  Mat4 singular;
  singular.m[3][3] = 0;
  CHECK_THROWS_AS(inverse(singular), Error);
}

TEST_CASE("matrices: determinant of a product is the product, and of the transpose the same") {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const Mat3 a = random_matrix3(seed), b = random_matrix3(seed + 500);
    CHECK(determinant(a * b) == doctest::Approx(determinant(a) * determinant(b)).epsilon(1e-9));
    CHECK(determinant(transpose(a)) == doctest::Approx(determinant(a)));
  }
}

TEST_CASE("matrices: a 4x4 that needs a pivot inverts") {
  Mat4 swap;
  swap.m[0][0] = swap.m[1][1] = 0;
  swap.m[0][1] = swap.m[1][0] = 1;
  CHECK(inverse(swap) == swap);
  const Vec4 v = swap * Vec4{1, 2, 3, 4};
  CHECK(v == Vec4{2, 1, 3, 4});
}

TEST_CASE("boxes: empty until something is added, NaN is ignored") {
  Box3 b;
  CHECK(b.empty());
  CHECK(b.diagonal() == 0);
  b.add(Box3());
  CHECK(b.empty());
  b.add(Vec3(1, 2, 3));
  CHECK_FALSE(b.empty());
  CHECK(b.size() == Vec3(0, 0, 0));
  b.add(Vec3(NAN, 5, NAN));
  CHECK(b.lo == Vec3(1, 2, 3));
  CHECK(b.hi == Vec3(1, 5, 3));
  Box3 c;
  c.add(Vec3(-1, 0, 3));
  b.add(c);
  CHECK(b.center() == Vec3(0, 2.5, 3));
  CHECK(b.diagonal() == doctest::Approx(std::sqrt(29.0)));
  b.add(Vec3(-HUGE_VAL, 3, 3)), b.add(Vec3(HUGE_VAL, 3, HUGE_VAL));
  CHECK(b.center() == Vec3(0, 2.5, 0));  // places relative to it stay finite
}
