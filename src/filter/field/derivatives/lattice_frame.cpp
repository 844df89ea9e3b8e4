// SPDX-License-Identifier: Apache-2.0
#include "filter/field/derivatives/lattice_frame.h"

#include <algorithm>

namespace sg {

namespace {

// Weights of the derivative at 0 of the parabola through three places at distances d (one of which is 0).
void parabola(AxisStencil& s) {
  for (int k = 0; k < 3; ++k) {
    const double a = s.d[(k + 1) % 3], b = s.d[(k + 2) % 3];
    s.w[k] = -(a + b) / ((s.d[k] - a) * (s.d[k] - b));
  }
}

std::vector<AxisStencil> stencils(size_t n, ptrdiff_t stride, const double* x) {
  std::vector<AxisStencil> r(n);
  if (n < 2) return r;
  for (size_t i = 0; i < n; ++i) {
    AxisStencil& s = r[i];
    const ptrdiff_t first = n == 2 ? -ptrdiff_t(i) : i == 0 ? 0 : i + 1 == n ? -2 : -1;
    const int members = n == 2 ? 2 : 3;
    for (int k = 0; k < members; ++k) {
      s.o[k] = (first + k) * stride;
      s.d[k] = x ? x[ptrdiff_t(i) + first + k] - x[i] : double(first + k);
    }
    if (n == 2) {
      s.w[1] = 1.0 / (s.d[1] - s.d[0]);
      s.w[0] = -s.w[1];
    } else {
      parabola(s);
    }
  }
  return r;
}

// Three independent directions: the given ones, with unit normals in place of those that are missing or flat.
Mat3 completed(Vec3 a[3]) {
  const double scale = std::max({length(a[0]), length(a[1]), length(a[2])});
  bool good[3];
  int n = 0;
  for (int l = 0; l < 3; ++l) n += good[l] = length(a[l]) > 1e-12 * scale && scale > 0;
  for (int l = 0; l < 3 && n < 3; ++l) {
    if (good[l]) continue;
    const Vec3 u = a[(l + 1) % 3], v = a[(l + 2) % 3];
    const bool gu = good[(l + 1) % 3], gv = good[(l + 2) % 3];
    if (gu && gv) {
      a[l] = normalize(cross(u, v));
    } else {
      const Vec3 w = gu ? u : gv ? v : Vec3(1, 0, 0);
      const Vec3 other = std::abs(w.x) <= std::abs(w.y) && std::abs(w.x) <= std::abs(w.z) ? Vec3(1, 0, 0)
                         : std::abs(w.y) <= std::abs(w.z)                                 ? Vec3(0, 1, 0)
                                                                                          : Vec3(0, 0, 1);
      a[l] = normalize(cross(w, other));
    }
    good[l] = true, ++n;
  }
  Mat3 m;
  for (int l = 0; l < 3; ++l)
    for (int c = 0; c < 3; ++c) m.m[l][c] = a[l][c];
  return m;
}

// Inverse by cofactors; the zero matrix when singular.
Mat3 inverse_or_zero(const Mat3& m) {
  const Vec3 r[3] = {{m.m[0][0], m.m[0][1], m.m[0][2]}, {m.m[1][0], m.m[1][1], m.m[1][2]}, {m.m[2][0], m.m[2][1], m.m[2][2]}};
  const Vec3 c[3] = {cross(r[1], r[2]), cross(r[2], r[0]), cross(r[0], r[1])};
  const double d = dot(r[0], c[0]);
  Mat3 out;
  const bool good = std::abs(d) > 1e-14 * length(r[0]) * length(r[1]) * length(r[2]);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out.m[i][j] = good ? c[j][i] / d : 0.0;
  return out;
}

}  // namespace

LatticeFrame::LatticeFrame(const LatticeView& v) : view(v) {
  int at = 0;
  for (int pass = 0; pass < 2; ++pass)
    for (int a = 0; a < 3; ++a)
      if ((v.dims[size_t(a)] > 1) == (pass == 0)) source[size_t(at++)] = a, axes += pass == 0;
  for (size_t l = 0; l < 3; ++l) dims[l] = v.dims[size_t(source[l])];
  stride = {1, ptrdiff_t(dims[0]), ptrdiff_t(dims[0] * dims[1])};
  Vec3 direction[3];
  for (size_t l = 0; l < 3; ++l) {
    const int a = source[l];
    const bool separable = v.mode == LatticeView::Mode::separable;
    stencil[l] = stencils(dims[l], stride[l], separable ? v.axis[a] : nullptr);
    if (separable) direction[l][a] = 1;
    else if (v.mode == LatticeView::Mode::affine && dims[l] > 1) direction[l] = v.step[a];
  }
  if (v.mode != LatticeView::Mode::listed) to_world = inverse_or_zero(completed(direction));
}

Mat3 LatticeFrame::metric(size_t p, const size_t at[3]) const {
  Vec3 d[3];
  for (int l = 0; l < axes; ++l) {
    const AxisStencil& s = stencil[l][at[l]];
    for (int k = 0; k < 3; ++k)
      if (s.w[k] != 0) d[l] += (listed(size_t(ptrdiff_t(p) + s.o[k])) - view.origin) * s.w[k];
  }
  return inverse_or_zero(completed(d));
}

bool LatticeFrame::right_handed() const {
  if (axes < 3) return true;
  // A lattice that is not folded has one sign everywhere; flat cells (poles, seams) have none, so many points vote.
  long votes = 0;
  const size_t tries = 9;
  for (size_t a = 0; a < tries; ++a)
    for (size_t b = 0; b < tries; ++b)
      for (size_t c = 0; c < tries; ++c) {
        const size_t i = a * (dims[0] - 2) / (tries - 1), j = b * (dims[1] - 2) / (tries - 1), k = c * (dims[2] - 2) / (tries - 1);
        const Vec3 p = position(i, j, k);
        const double d = dot(position(i + 1, j, k) - p, cross(position(i, j + 1, k) - p, position(i, j, k + 1) - p));
        votes += d > 0 ? 1 : d < 0 ? -1 : 0;
      }
  return votes >= 0;
}

}  // namespace sg
