// SPDX-License-Identifier: Apache-2.0
#include "filter/field/derivatives/gradient_rows.h"

#include <algorithm>

namespace sg {

namespace {

// d[i] = w0 f[i + o0] + w1 f[i + o1] (+ w2 f[i + o2]): the same stencil for a whole row.
template <class T>
void across(const AxisStencil& s, T scale, const T* f, T* d, size_t n) {
  const T w0 = T(s.w[0]) * scale, w1 = T(s.w[1]) * scale, w2 = T(s.w[2]) * scale;
  const T *a = f + s.o[0], *b = f + s.o[1], *c = f + s.o[2];
  if (s.w[1] == 0 && s.w[0] == -s.w[2]) {  // central: one multiplication
    for (size_t i = 0; i < n; ++i) d[i] = w2 * (c[i] - a[i]);
  } else if (s.w[2] == 0 && s.w[0] == -s.w[1]) {
    for (size_t i = 0; i < n; ++i) d[i] = w1 * (b[i] - a[i]);
  } else {
    for (size_t i = 0; i < n; ++i) d[i] = w0 * a[i] + w1 * b[i] + w2 * c[i];
  }
}

// Along the row: stencils that differ from point to point only at the two ends.
template <class T>
void along(const std::vector<AxisStencil>& stencil, T scale, const T* f, T* d, size_t n) {
  auto one = [&](size_t i) {
    const AxisStencil& s = stencil[i];
    T sum = 0;
    for (int k = 0; k < 3; ++k)
      if (s.w[k] != 0) sum += T(s.w[k]) * scale * f[ptrdiff_t(i) + s.o[k]];
    d[i] = sum;
  };
  one(0);
  if (n > 1) one(n - 1);
  if (n > 2) across(stencil[1], scale, f + 1, d + 1, n - 2);
}

// The sum is finite unless a number is not (or huge ones cancel: then the careful path costs time, nothing else).
template <class T>
bool finite(const T* v, size_t n) {
  T sum[8] = {};
  size_t i = 0;
  for (; i + 8 <= n; i += 8)
    for (size_t k = 0; k < 8; ++k) sum[k] += v[i + k] * T(0);
  for (; i < n; ++i) sum[0] += v[i] * T(0);
  T all = 0;
  for (const T s : sum) all += s;
  return all == 0;
}

template <class T>
bool row(const LatticeFrame& frame, const T* f, T* out, size_t r, std::vector<T>& scratch) {
  const size_t nx = frame.dims[0], at[3] = {0, r % frame.dims[1], r / frame.dims[1]};
  scratch.resize(3 * nx);
  const T* here = f + r * nx;
  T* d[3] = {scratch.data(), scratch.data() + nx, scratch.data() + 2 * nx};
  // to_world is diagonal here: it scales derivatives by index to derivatives by length.
  along(frame.stencil[0], T(frame.to_world.m[0][0]), here, d[0], nx);
  for (int l = 1; l < 3; ++l) {
    if (l < frame.axes) across(frame.stencil[l][at[l]], T(frame.to_world.m[l][l]), here, d[l], nx);
    else std::fill_n(d[l], nx, T(0));
  }
  if (!finite(here, nx) || !finite(scratch.data(), 3 * nx)) return false;
  T* o = out + 3 * r * nx;
  for (size_t i = 0; i < nx; ++i) o[3 * i] = d[0][i], o[3 * i + 1] = d[1][i], o[3 * i + 2] = d[2][i];
  return true;
}

}  // namespace

bool has_fast_rows(const LatticeFrame& frame) {
  if (frame.axes == 0 || frame.view.mode != LatticeView::Mode::affine) return false;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      if (a != b && frame.to_world.m[a][b] != 0) return false;
  return frame.source[0] == 0 && (frame.axes < 2 || frame.source[1] == 1) && (frame.axes < 3 || frame.source[2] == 2);
}

bool fast_row_gradient(const LatticeFrame& frame, const float* f, float* out, size_t r, std::vector<float>& scratch) {
  return row(frame, f, out, r, scratch);
}
bool fast_row_gradient(const LatticeFrame& frame, const double* f, double* out, size_t r, std::vector<double>& scratch) {
  return row(frame, f, out, r, scratch);
}

}  // namespace sg
