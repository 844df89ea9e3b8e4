// SPDX-License-Identifier: Apache-2.0
#include "base/space/euler.h"

#include "base/random.h"
#include "base/space/matrix_distance.h"
#include "base/space/rotation.h"
#include "support/test.h"

using namespace sg;
using test::apart;

namespace {

bool names_twice(EulerOrder order) { return axes_of(order)[0] == axes_of(order)[2]; }

}  // namespace

TEST_CASE("Euler angles: xyz turns about x first, then y, then z, all of them fixed") {
  const Mat3 m = euler_matrix({90, 0, 90}, EulerOrder::xyz);
  CHECK(m * Vec3(0, 1, 0) == Vec3(0, 0, 1));  // y to z by the turn about x, where the one about z leaves it
  CHECK(m * Vec3(1, 0, 0) == Vec3(0, 1, 0));
  const Vec3 a{20, -35, 70};
  CHECK(apart(euler_matrix(a, EulerOrder::xyz), turn_about({0, 0, 1}, 70) * turn_about({0, 1, 0}, -35) * turn_about({1, 0, 0}, 20)) <
        1e-15);
  // About the body's own axes in the reverse order: z, then the turned y, then the turned x.
  const Mat3 z = turn_about({0, 0, 1}, 70), zy = turn_about(z * Vec3(0, 1, 0), -35) * z, zyx = turn_about(zy * Vec3(1, 0, 0), 20) * zy;
  CHECK(apart(euler_matrix(a, EulerOrder::xyz), zyx) < 1e-15);
}

TEST_CASE("Euler angles: in every order the angles come back, and any rotation has angles that make it") {
  for (const auto& [word, order] : enum_words(EulerOrder())) {
    const bool twice = names_twice(order);
    for (uint64_t n = 0; n < 200; ++n) {
      const Vec3 a{340 * (random_unit(n, 0) - 0.5), twice ? 5 + 170 * random_unit(n, 1) : 170 * (random_unit(n, 1) - 0.5),
                   340 * (random_unit(n, 2) - 0.5)};
      const EulerAngles e = euler_of(euler_matrix(a, order), order);
      CAPTURE(word);
      CHECK_FALSE(e.locked);
      CHECK(length(e.degrees - a) < 1e-11);
      const Mat3 any = turn_about({random_unit(n, 3) - 0.5, random_unit(n, 4) - 0.5, random_unit(n, 5) - 0.5}, 360 * random_unit(n, 6));
      CHECK(apart(euler_matrix(euler_of(any, order).degrees, order), any) < 1e-14);
    }
  }
}

TEST_CASE("Euler angles: in gimbal lock the first angle takes the whole turn, and near it no digit is lost") {
  for (const auto& [word, order] : enum_words(EulerOrder())) {
    CAPTURE(word);
    const bool twice = names_twice(order);
    for (const double middle : twice ? std::array{0.0, 180.0} : std::array{90.0, -90.0}) {
      // Two poses of different angles are the same rotation: one degree of freedom is lost.
      const Mat3 m = euler_matrix({50, middle, 20}, order);
      const EulerAngles e = euler_of(m, order);
      CHECK(e.locked);
      CHECK(e.degrees.z == 0);
      CHECK(std::abs(e.degrees.y - middle) < 1e-12);
      CHECK((std::abs(e.degrees.x - 70) < 1e-12 || std::abs(e.degrees.x - 30) < 1e-12));
      CHECK(apart(euler_matrix(e.degrees, order), m) < 1e-15);
      for (const double off : {1e-3, 1e-6, 1e-9, 1e-11, 1e-13}) {
        const Mat3 near = euler_matrix({50, middle - (middle > 0 ? off : -off), 20}, order);
        CHECK(apart(euler_matrix(euler_of(near, order).degrees, order), near) < 1e-12);
        if (off >= 1e-9) CHECK(apart(euler_matrix(euler_of(near, order).degrees, order), near) < 4e-15);
      }
    }
  }
}
