// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/line_batch.h"

#include <algorithm>
#include <cmath>

namespace sg::texture {

LineBatch::LineBatch(int most_steps, bool with_pixels)
    : steps(most_steps), noise(size_t(2 * most_steps + 1) * lanes), pixels(with_pixels ? size_t(2 * most_steps + 1) * lanes : 0) {}

namespace {

// Without branches, so that the compiler makes vectors of it.
template <int D>
inline uint32_t encoded(const float* v) {
  float most = std::abs(v[0]), x[D], square = 0;
  for (int a = 1; a < D; ++a) most = std::max(most, std::abs(v[a]));
  const float inverse = 1 / most;  // squares of tiny numbers vanish
  for (int a = 0; a < D; ++a) x[a] = v[a] * inverse, square += x[a] * x[a];
  const bool good = square > 0.9f && square <= float(D) + 0.1f;  // not for 0, infinity and NaN
  const float scale = good ? code_scale(D) / std::sqrt(square) : 0.0f;
  constexpr int bits = D == 2 ? 16 : 10;
  uint32_t code = 0;
  for (int a = 0; a < D; ++a) {
    const float y = good ? x[a] * scale : 0.0f;
    code |= (uint32_t(int32_t(y + (y < 0 ? -0.5f : 0.5f))) & ((1u << bits) - 1)) << (bits * a);
  }
  return code;
}

}  // namespace

uint32_t encode_direction(int dimension, const float* v) { return dimension == 2 ? encoded<2>(v) : encoded<3>(v); }

void encode_directions(int dimension, const float* v, size_t n, uint32_t* codes) {
  if (dimension == 2)
    for (size_t i = 0; i < n; ++i) codes[i] = encoded<2>(v + 2 * i);
  else
    for (size_t i = 0; i < n; ++i) codes[i] = encoded<3>(v + 3 * i);
}

namespace {

// All sums and products in the order of the vector version.
template <int D>
void look(const DirectionGrid& g, const float* p, float* v) {
  int32_t index = 0, stride[D];
  float f[D];
  for (int a = 0, s = 1; a < D; s *= g.n[a], ++a) {
    const int32_t i = std::min(int32_t(p[a]), g.n[a] - 2);
    f[a] = p[a] - float(i), index += i * s, stride[a] = s;
  }
  float c[1 << D][D];
  for (int k = 0; k < 1 << D; ++k) {
    int32_t at = index;
    for (int a = 0; a < D; ++a)
      if (k >> a & 1) at += stride[a];
    const uint32_t code = g.codes[at];
    if constexpr (D == 2) {
      c[k][0] = float(int32_t(code << 16) >> 16), c[k][1] = float(int32_t(code) >> 16);
    } else {
      c[k][0] = float(int32_t(code << 22) >> 22), c[k][1] = float(int32_t(code << 12) >> 22), c[k][2] = float(int32_t(code << 2) >> 22);
    }
  }
  for (int a = 0; a < D; ++a)
    for (int k = 0; k < 1 << (D - 1 - a); ++k)
      for (int b = 0; b < D; ++b) c[k][b] = c[2 * k][b] + f[a] * (c[2 * k + 1][b] - c[2 * k][b]);
  for (int b = 0; b < D; ++b) v[b] = c[0][b];
}

// The nearest pixel of a place.
template <int D>
void record(const DirectionGrid& g, LineBatch& batch, const float* p, size_t row, bool& in_box) {
  int32_t pixel = 0, local = 0;
  in_box = true;
  for (int a = D - 1; a >= 0; --a) {
    const int32_t i = int32_t(p[a] + 0.5f);
    pixel = pixel * g.n[a] + i;
    local = local * (batch.box_hi[a] - batch.box_lo[a]) + (i - batch.box_lo[a]);
    in_box = in_box && i >= batch.box_lo[a] && i < batch.box_hi[a];
  }
  batch.noise[row] = g.noise[pixel];
  if (!batch.pixels.empty()) batch.pixels[row] = batch.tail == 0 ? pixel : in_box ? local : -1;
}

template <int D>
int walk(const DirectionGrid& g, LineBatch& batch, int lane, int way) {
  const float h = float(way) * batch.step / code_scale(D), least = least_direction * code_scale(D);
  const float longer = 1.5f * h, shorter = 0.5f * h;
  float p[D], v[D], last[D] = {}, q[D];
  for (int a = 0; a < D; ++a) p[a] = batch.start[a][lane];
  int made = 0, since = -1;
  for (int k = 0; k < batch.steps; ++k) {
    look<D>(g, p, v);
    float square = v[0] * v[0];
    for (int a = 1; a < D; ++a) square = square + v[a] * v[a];
    if (!(square > least * least)) break;
    if (k == 0) {
      float m[D], w[D];
      for (int a = 0; a < D; ++a) m[a] = std::min(std::max(p[a] + shorter * v[a], 0.0f), float(g.n[a] - 1));
      look<D>(g, m, w);
      for (int a = 0; a < D; ++a) q[a] = p[a] + h * w[a];
    } else {
      for (int a = 0; a < D; ++a) q[a] = p[a] + (longer * v[a] - shorter * last[a]);
    }
    bool inside = true;
    for (int a = 0; a < D; ++a) inside = inside && q[a] >= 0 && q[a] <= float(g.n[a] - 1);
    if (!inside) break;
    for (int a = 0; a < D; ++a) last[a] = v[a], p[a] = q[a];
    bool in_box;
    const size_t row = size_t(batch.steps + way * (k + 1)) * lanes + size_t(lane);
    record<D>(g, batch, p, row, in_box);
    ++made;
    if (in_box) since = k;
    if (batch.tail > 0 && k - since >= batch.tail) break;
  }
  return made;
}

template <int D>
void trace(const DirectionGrid& g, LineBatch& batch) {
  std::fill(batch.noise.begin(), batch.noise.end(), 0.0f);
  std::fill(batch.pixels.begin(), batch.pixels.end(), -1);
  for (int lane = 0; lane < lanes; ++lane) {
    float p[D];
    for (int a = 0; a < D; ++a) p[a] = batch.start[a][lane];
    bool in_box;
    record<D>(g, batch, p, size_t(batch.steps) * lanes + size_t(lane), in_box);
    batch.forth[lane] = walk<D>(g, batch, lane, 1);
    batch.back[lane] = walk<D>(g, batch, lane, -1);
  }
}

}  // namespace

void trace_lines_scalar(const DirectionGrid& grid, LineBatch& batch) {
  grid.dimension == 2 ? trace<2>(grid, batch) : trace<3>(grid, batch);
}

void convolve_lines_scalar(const LineBatch& batch, const Weights& weights, int first, int last, float* out) {
  const int rows = 2 * batch.steps + 1, n = weights.steps;
  auto noise = [&](int row, int lane) { return row < 0 || row >= rows ? 0.0f : batch.noise[size_t(row) * lanes + size_t(lane)]; };
  for (int lane = 0; lane < lanes; ++lane) {
    float s = 0;
    for (int m = first; m <= last; ++m) {
      if (!weights.box || m == first) {
        s = 0;
        for (int k = -n; k <= n; ++k)
          if (m + k >= 0 && m + k < rows) s = s + weights.w[size_t(n + k)] * noise(m + k, lane);
      } else {
        s = s + (noise(m + n, lane) - noise(m - n - 1, lane));
      }
      out[size_t(m - first) * lanes + size_t(lane)] = s;
    }
  }
}

}  // namespace sg::texture
