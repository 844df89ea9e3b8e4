// SPDX-License-Identifier: Apache-2.0
#include "base/space/euler.h"

#include <cmath>
#include <numbers>

#include "base/space/rotation.h"

namespace sg {

namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double lock = 1e-12;  // sine of the angle to gimbal lock, below which rounding alone would tell the first angle

Mat3 about(int axis, double degrees) {
  Vec3 a;
  a[axis] = 1;
  return turn_about(a, degrees);
}

}  // namespace

std::array<int, 3> axes_of(EulerOrder order) {
  const std::string_view word = word_of(order);
  return {word[0] - 'x', word[1] - 'x', word[2] - 'x'};
}

Mat3 euler_matrix(Vec3 degrees, EulerOrder order) {
  const auto [i, j, k] = axes_of(order);
  return about(k, degrees.z) * about(j, degrees.y) * about(i, degrees.x);
}

EulerAngles euler_of(const Mat3& rotation, EulerOrder order) {
  const auto [i, j, last] = axes_of(order);
  const int k = 3 - i - j;
  const bool twice = last == i;
  const double p = (i + 1) % 3 == j ? 1 : -1;  // are i, j, k a right-handed frame?
  const auto& m = rotation.m;
  EulerAngles e;
  // The row that the third turn leaves alone tells the first two.
  const double a = twice ? m[i][j] : p * m[k][j], b = twice ? p * m[i][k] : m[k][k];
  e.locked = std::hypot(a, b) < lock;
  const double first = e.locked ? std::atan2(-p * m[j][k], m[j][j]) : std::atan2(a, b);
  e.degrees.x = first / degree;
  const Mat3 rest = rotation * about(i, -e.degrees.x);  // the third turn times the second
  const auto& r = rest.m;
  e.degrees.y = (twice ? std::abs(std::atan2(p * r[i][k], r[i][i])) : std::atan2(-p * r[k][i], r[k][k])) / degree;
  if (!e.locked) e.degrees.z = (twice ? std::atan2(p * r[k][j], r[j][j]) : std::atan2(-p * r[i][j], r[j][j])) / degree;
  return e;
}

}  // namespace sg
