// SPDX-License-Identifier: Apache-2.0
#include "base/vec.h"

#include <utility>

#include "base/error.h"

namespace sg {

double determinant(const Mat3& a) { return dot(a.column(0), cross(a.column(1), a.column(2))); }

Mat3 transpose(const Mat3& a) {
  Mat3 r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r.m[i][j] = a.m[j][i];
  return r;
}

Mat3 inverse(const Mat3& a) {
  const double d = determinant(a);
  if (d == 0 || !std::isfinite(d)) fail_internal("matrix has no inverse");
  const Vec3 rows[3] = {cross(a.column(1), a.column(2)) / d, cross(a.column(2), a.column(0)) / d, cross(a.column(0), a.column(1)) / d};
  Mat3 r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r.m[i][j] = rows[i][j];
  return r;
}

// Gauss-Jordan with partial pivoting.
Mat4 inverse(const Mat4& a) {
  Mat4 w = a, r;
  for (int c = 0; c < 4; ++c) {
    int pivot = c;
    for (int i = c + 1; i < 4; ++i)
      if (std::abs(w.m[i][c]) > std::abs(w.m[pivot][c])) pivot = i;
    if (!(std::abs(w.m[pivot][c]) > 0)) fail_internal("matrix has no inverse");
    for (int j = 0; j < 4; ++j) std::swap(w.m[c][j], w.m[pivot][j]), std::swap(r.m[c][j], r.m[pivot][j]);
    const double p = w.m[c][c];
    for (int j = 0; j < 4; ++j) w.m[c][j] /= p, r.m[c][j] /= p;
    for (int i = 0; i < 4; ++i) {
      const double f = w.m[i][c];
      if (i == c || f == 0) continue;
      for (int j = 0; j < 4; ++j) w.m[i][j] -= f * w.m[c][j], r.m[i][j] -= f * r.m[c][j];
    }
  }
  return r;
}

}  // namespace sg
