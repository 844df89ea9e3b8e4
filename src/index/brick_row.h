// SPDX-License-Identifier: Apache-2.0
// Ranges of a row of cubes of a lattice, whatever their edge.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "index/minmax_bricks.h"

namespace sg {

/// The nearest float not above (below) v, so that ranges of 64-bit and large integer values still enclose them.
template <class T>
float round_down(T v) {
  const float f = float(v);
  if constexpr (sizeof(T) <= 2 || std::is_same_v<T, float>) return f;
  return double(f) > double(v) || sizeof(T) == 8 ? std::nextafterf(f, -HUGE_VALF) : f;
}
template <class T>
float round_up(T v) {
  const float f = float(v);
  if constexpr (sizeof(T) <= 2 || std::is_same_v<T, float>) return f;
  return double(f) < double(v) || sizeof(T) == 8 ? std::nextafterf(f, HUGE_VALF) : f;
}

/// One row of cubes of `edge` cells along x, the first sample of each at (x, y0, z0). Rows of samples are folded into one row of minima and
/// one of maxima first: that loop is elementwise and runs at memory speed. `v < lo ? v : lo` keeps lo when v is NaN.
template <class T>
void brick_row(const T* values, const std::array<size_t, 3>& dims, size_t y0, size_t z0, std::vector<T>& lo, std::vector<T>& hi,
               size_t edge, MinMaxBricks::Range* out, size_t bricks) {
  using Limits = std::numeric_limits<T>;
  const T top = Limits::has_infinity ? Limits::infinity() : Limits::max(),
          bottom = Limits::has_infinity ? -Limits::infinity() : Limits::lowest();
  const size_t nx = dims[0], y1 = std::min(y0 + edge, dims[1] - 1), z1 = std::min(z0 + edge, dims[2] - 1);
  lo.assign(nx, top), hi.assign(nx, bottom);
  T *l = lo.data(), *h = hi.data();
  for (size_t z = z0; z <= z1; ++z)
    for (size_t y = y0; y <= y1; ++y) {
      const T* row = values + nx * (y + dims[1] * z);
      for (size_t x = 0; x < nx; ++x) {
        l[x] = row[x] < l[x] ? row[x] : l[x];
        h[x] = row[x] > h[x] ? row[x] : h[x];
      }
    }
  for (size_t b = 0; b < bricks; ++b) {
    const size_t x0 = b * edge, x1 = std::min(x0 + edge, nx - 1);
    T bl = top, bh = bottom;
    for (size_t x = x0; x <= x1; ++x) bl = std::min(bl, l[x]), bh = std::max(bh, h[x]);
    // Only a cube with nothing but NaN leaves bl > bh.
    if (bl > bh) out[b] = {HUGE_VALF, -HUGE_VALF};
    else out[b] = {round_down(bl), round_up(bh)};
  }
}

}  // namespace sg
