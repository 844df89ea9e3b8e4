// SPDX-License-Identifier: Apache-2.0
#include "base/space/rotation.h"

#include <numbers>

#include "base/random.h"
#include "base/space/matrix_distance.h"
#include "support/test.h"

using namespace sg;
using test::apart;

namespace {

Quaternion random_quaternion(uint64_t seed) {
  return normalize(
      Quaternion{random_unit(seed, 0) - 0.5, random_unit(seed, 1) - 0.5, random_unit(seed, 2) - 0.5, random_unit(seed, 3) - 0.5});
}

}  // namespace

TEST_CASE("rotation: a quaternion, its matrix and the matrix about its axis turn alike, and come back") {
  for (uint64_t n = 0; n < 300; ++n) {
    const Vec3 axis(random_unit(n, 4) - 0.5, random_unit(n, 5) - 0.5, random_unit(n, 6) - 0.5);
    const double degrees = 720 * (random_unit(n, 7) - 0.5);
    const Quaternion q = quaternion_about(axis, degrees);
    const Mat3 m = turn_about(axis, degrees);
    CHECK(length(q) == doctest::Approx(1).epsilon(1e-14));
    CHECK(apart(matrix_of(q), m) < 1e-14);
    CHECK(apart(transpose(m) * m, Mat3()) < 1e-14);
    CHECK(determinant(m) == doctest::Approx(1).epsilon(1e-13));
    CHECK(length(m * axis - axis) < 1e-14);
    const Quaternion back = quaternion_of(m);
    CHECK(back.w >= 0);
    CHECK(std::abs(std::abs(dot(back, q)) - 1) < 1e-14);
    const Quaternion other = random_quaternion(n);
    CHECK(apart(matrix_of(q * other), m * matrix_of(other)) < 1e-14);  // first the right one
    CHECK(apart(matrix_of(q.conjugate()), transpose(m)) < 1e-14);
  }
}

TEST_CASE("rotation: half turns, of which no part but one of the quaternion is left, keep their axis") {
  for (int a = 0; a < 3; ++a) {
    Vec3 axis;
    axis[a] = 1;
    const Mat3 m = turn_about(axis, 180);
    CHECK(apart(matrix_of(quaternion_of(m)), m) == 0);
  }
  const Mat3 skew = turn_about({1, 2, -3}, 180);
  CHECK(apart(matrix_of(quaternion_of(skew)), skew) < 1e-15);
}

TEST_CASE("rotation: quarter turns are exact, and the right hand tells the sense") {
  CHECK(turn_about({0, 0, 1}, 90) * Vec3(1, 0, 0) == Vec3(0, 1, 0));
  CHECK(turn_about({1, 0, 0}, 450) * Vec3(0, 1, 0) == Vec3(0, 0, 1));
  CHECK(turn_about({0, 5, 0}, -90) * Vec3(1, 0, 0) == Vec3(0, 0, 1));
}

TEST_CASE("slerp: constant speed along the shorter arc, with the ends as they are") {
  const Quaternion from = quaternion_about({0, 0, 1}, 10);
  for (const double turn : {1e-9, 1e-4, 40.0, 179.0}) {
    Quaternion to = quaternion_about({0, 0, 1}, 10 + turn);
    for (const double sign : {1.0, -1.0}) {  // -q is the same rotation: the way must not depend on it
      to = {sign * to.w, sign * to.x, sign * to.y, sign * to.z};
      for (const double t : {0.0, 0.125, 0.5, 1.0, 1.5}) {
        const Mat3 wanted = turn_about({0, 0, 1}, 10 + t * turn);
        CHECK(apart(matrix_of(slerp(from, to, t)), wanted) < 1e-14);
      }
    }
  }
  // 350 degrees on is 10 degrees back.
  const Quaternion back = slerp({}, quaternion_about({0, 1, 0}, 350), 0.5);
  CHECK(apart(matrix_of(back), turn_about({0, 1, 0}, -5)) < 1e-14);
  CHECK(slerp(from, from, 0.3) == normalize(from));
}

TEST_CASE("rotation: what is none is refused") {
  CHECK(test::contains(test::error_of([] { normalize(Quaternion{0, 0, 0, 0}); }), "no rotation"));
  CHECK(test::contains(test::error_of([] { normalize(Quaternion{NAN, 0, 0, 1}); }), "no rotation"));
  CHECK(test::contains(test::error_of([] { turn_about({0, 0, 0}, 5); }), "axis is zero"));
  CHECK(length(normalize(Quaternion{1e-200, 1e-200, 0, 0})) == doctest::Approx(1));
  CHECK(length(normalize(Quaternion{1e200, 0, 1e200, 0})) == doctest::Approx(1));
}
