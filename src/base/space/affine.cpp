// SPDX-License-Identifier: Apache-2.0
#include "base/space/affine.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace sg {

namespace {

double largest(const Mat3& a) {
  double most = 0;
  for (const auto& row : a.m)
    for (const double v : row) most = std::max(most, std::abs(v));
  return most;
}
double frobenius(const Mat3& a) {
  double sum = 0;
  for (const auto& row : a.m)
    for (const double v : row) sum += v * v;
  return std::sqrt(sum);
}
// a + (b - a) t
Mat3 between(const Mat3& a, const Mat3& b, double t) {
  Mat3 r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r.m[i][j] = a.m[i][j] * (1 - t) + b.m[i][j] * t;
  return r;
}

}  // namespace

bool is_invertible(const Affine& a) {
  constexpr double flat = 1e-12;
  const double most = largest(a.linear), det = determinant(a.linear);
  return std::isfinite(det) && std::isfinite(a.shift.x + a.shift.y + a.shift.z) && std::abs(det) > flat * most * most * most;
}

Affine inverse(const Affine& a) {
  const Mat3 back = inverse(a.linear);
  return {back, -(back * a.shift)};
}

Box3 moved(const Affine& a, const Box3& box) {
  Box3 r;
  if (box.empty()) return r;
  for (int c = 0; c < 8; ++c) r.add(a({c & 1 ? box.hi.x : box.lo.x, c & 2 ? box.hi.y : box.lo.y, c & 4 ? box.hi.z : box.lo.z}));
  return r;
}

Polar polar_decomposition(const Mat3& m) {
  const double size = largest(m);
  Mat3 q;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) q.m[i][j] = m.m[i][j] / size;
  if (!is_invertible({q, {}})) fail_usage("the matrix is singular", "polar decomposition", "it must not flatten space");
  // Quadratic once it is close; the factor brings it close whatever the stretch.
  constexpr int most_steps = 100;
  for (int step = 0; step < most_steps; ++step) {
    const Mat3 other = transpose(inverse(q));
    const double factor = std::sqrt(frobenius(other) / frobenius(q));
    Mat3 next;
    double change = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        next.m[i][j] = 0.5 * (factor * q.m[i][j] + other.m[i][j] / factor);
        change = std::max(change, std::abs(next.m[i][j] - q.m[i][j]));
      }
    q = next;
    if (change < 1e-15) break;
  }
  if (determinant(q) < 0)
    for (auto& row : q.m)
      for (double& v : row) v = -v;
  Polar p;
  p.rotation = q;
  const Mat3 s = transpose(q) * m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) p.stretch.m[i][j] = 0.5 * (s.m[i][j] + s.m[j][i]);
  return p;
}

AffineParts take_apart(const Affine& a) {
  const Polar p = polar_decomposition(a.linear);
  return {a.shift, quaternion_of(p.rotation), p.stretch};
}

Affine put_together(const AffineParts& parts) { return {matrix_of(parts.rotation) * parts.stretch, parts.shift}; }

Affine interpolate(const AffineParts& a, const AffineParts& b, double t) {
  return put_together({lerp(a.shift, b.shift, t), slerp(a.rotation, b.rotation, t), between(a.stretch, b.stretch, t)});
}

}  // namespace sg
