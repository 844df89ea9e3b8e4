// SPDX-License-Identifier: Apache-2.0
#include "base/space/rotation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"

namespace sg {

double dot(const Quaternion& a, const Quaternion& b) { return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z; }
double length(const Quaternion& q) { return std::sqrt(dot(q, q)); }

Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

Quaternion normalize(const Quaternion& q) {
  // Scaled first: squares of very large and very small numbers leave the range of doubles.
  const double most = std::max({std::abs(q.w), std::abs(q.x), std::abs(q.y), std::abs(q.z)});
  if (!(most > 0) || !std::isfinite(q.w + q.x + q.y + q.z))
    fail_usage("the quaternion is no rotation", "quaternion", "give x, y, z and w, finite and not all 0");
  const Quaternion s{q.w / most, q.x / most, q.y / most, q.z / most};
  const double l = length(s);
  return {s.w / l, s.x / l, s.y / l, s.z / l};
}

void sine_cosine(double degrees, double& s, double& c) {
  const double turn = std::remainder(degrees, 360.0), quarter = turn / 90.0;
  if (quarter == std::round(quarter)) {
    const int q = (int(quarter) + 4) % 4;
    s = q == 1 ? 1 : q == 3 ? -1 : 0;
    c = q == 0 ? 1 : q == 2 ? -1 : 0;
    return;
  }
  const double a = turn * (std::numbers::pi / 180.0);
  s = std::sin(a), c = std::cos(a);
}

Mat3 turn_about(Vec3 axis, double degrees) {
  Mat3 turn;
  if (degrees == 0) return turn;
  if (!(length(axis) > 0)) fail_usage("the rotation axis is zero", "axis", "give a direction, e.g. axis=0,0,1");
  const Vec3 u = normalize(axis);
  double s, c;
  sine_cosine(degrees, s, c);
  // cos I + sin [u]x + (1 - cos) u u^T
  const double cross_matrix[3][3] = {{0, -u.z, u.y}, {u.z, 0, -u.x}, {-u.y, u.x, 0}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) turn.m[i][j] = (i == j ? c : 0.0) + s * cross_matrix[i][j] + (1 - c) * u[i] * u[j];
  return turn;
}

Quaternion quaternion_about(Vec3 axis, double degrees) {
  if (degrees == 0) return {};
  if (!(length(axis) > 0)) fail_usage("the rotation axis is zero", "axis", "give a direction, e.g. axis=0,0,1");
  const Vec3 u = normalize(axis);
  const double half = std::remainder(degrees, 720.0) * (std::numbers::pi / 360.0), s = std::sin(half);
  return {std::cos(half), u.x * s, u.y * s, u.z * s};
}

Mat3 matrix_of(const Quaternion& q) {
  const auto [w, x, y, z] = q;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
           {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
           {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
}

Quaternion quaternion_of(const Mat3& a) {
  const auto& m = a.m;
  const double trace = m[0][0] + m[1][1] + m[2][2];
  Quaternion q;
  double* const part[3] = {&q.x, &q.y, &q.z};
  if (trace >= std::max({m[0][0], m[1][1], m[2][2]})) {
    const double r = std::sqrt(std::max(0.0, 1 + trace)), s = 0.5 / r;
    q = {0.5 * r, (m[2][1] - m[1][2]) * s, (m[0][2] - m[2][0]) * s, (m[1][0] - m[0][1]) * s};
  } else {
    const int i = m[0][0] >= m[1][1] && m[0][0] >= m[2][2] ? 0 : m[1][1] >= m[2][2] ? 1 : 2, j = (i + 1) % 3, k = (i + 2) % 3;
    const double r = std::sqrt(std::max(0.0, 1 + m[i][i] - m[j][j] - m[k][k])), s = 0.5 / r;
    q.w = (m[k][j] - m[j][k]) * s;
    *part[i] = 0.5 * r, *part[j] = (m[j][i] + m[i][j]) * s, *part[k] = (m[k][i] + m[i][k]) * s;
  }
  if (q.w < 0) q = {-q.w, -q.x, -q.y, -q.z};
  return normalize(q);
}

Quaternion slerp(const Quaternion& a, Quaternion b, double t) {
  double c = dot(a, b);
  if (c < 0) b = {-b.w, -b.x, -b.y, -b.z}, c = -c;
  // The angle from the chord and its complement: exact for close rotations, where the cosine is 1 whatever they are.
  const Quaternion apart{b.w - a.w, b.x - a.x, b.y - a.y, b.z - a.z}, sum{b.w + a.w, b.x + a.x, b.y + a.y, b.z + a.z};
  const double angle = 2 * std::atan2(length(apart), length(sum)), s = std::sin(angle);
  const double of_a = s > 1e-9 ? std::sin((1 - t) * angle) / s : 1 - t, of_b = s > 1e-9 ? std::sin(t * angle) / s : t;
  return normalize({of_a * a.w + of_b * b.w, of_a * a.x + of_b * b.x, of_a * a.y + of_b * b.y, of_a * a.z + of_b * b.z});
}

}  // namespace sg
