// SPDX-License-Identifier: Apache-2.0
// The rasterizer's inner loops: plain data in, plain data out. Internal to raster/.
#pragma once
#include <atomic>
#include <cstdint>
#include <vector>

#include "render/prepare/eye_view.h"

namespace sg::raster {

constexpr int subpixels = 256;        ///< steps of the vertex grid per pixel
constexpr float guard_band = 524288;  ///< pixels; triangles that reach beyond are clipped, so that edge functions fit 64 bits

/// Pixel grid position and what is linear on the picture: 1/z in perspective, z in parallel.
struct ScreenPoint {
  int32_t x, y;
  float w;
};

/// A triangle on the pixel grid, turned so that its edge functions are positive inside.
struct TriangleRecord {
  int32_t x[3], y[3];
  float w[3];
  uint32_t primitive;
};

/// Inclusive rectangle of pixels; empty when x0 > x1 or y0 > y1.
struct PixelBox {
  int x0, y0, x1, y1;
  bool empty() const { return x0 > x1 || y0 > y1; }
};
PixelBox pixel_box(const TriangleRecord& t, int width, int height);

/// Turns the triangle; false when it has no area or holds no pixel centre row or column of the picture.
bool finish_record(TriangleRecord& t, int width, int height);

/// Clips a triangle (near plane, guard band) and appends what is left of it, at most 6 triangles.
void clip_triangle(const EyeView& v, const float* a, const float* b, const float* c, uint32_t primitive, std::vector<TriangleRecord>& out);

constexpr uint64_t empty_key(float far_plane) { return uint64_t(__builtin_bit_cast(uint32_t, far_plane)) << 32 | 0xFFFFFFFFu; }
inline uint64_t depth_key(float depth, uint32_t primitive) { return uint64_t(__builtin_bit_cast(uint32_t, depth)) << 32 | primitive; }
inline float key_depth(uint64_t key) { return __builtin_bit_cast(float, uint32_t(key >> 32)); }

/// The minimum does not depend on the order in which threads come.
inline void keep_nearer(uint64_t* slot, uint64_t key) {
  std::atomic_ref<uint64_t> a(*slot);
  uint64_t seen = a.load(std::memory_order_relaxed);
  while (key < seen && !a.compare_exchange_weak(seen, key, std::memory_order_relaxed)) {
  }
}

/// Triangles begin..end of one item: small ones (at most `small` pixels wide and high) are drawn into `keys` with an atomic minimum,
/// the others are appended to `large`. keys: one per pixel of the picture.
struct TriangleJob {
  EyeView view;
  const float* xyz;
  const uint32_t* triangles;
  uint32_t first_primitive;
  int small;
  uint64_t* keys;
};
void draw_triangles(const TriangleJob& job, size_t begin, size_t end, std::vector<TriangleRecord>& large);
void draw_triangles_reference(const TriangleJob& job, size_t begin, size_t end, std::vector<TriangleRecord>& large);

/// Calls f(y, x0, x1) with the pixels x0..x1 of each row inside `box` whose centres the triangle covers.
template <class F>
void for_each_span(const TriangleRecord& t, const PixelBox& box, F&& f) {
  struct Edge {
    int64_t dx, dy, x, y, bias;
  } e[3];
  for (int k = 0; k < 3; ++k) {
    const int n = (k + 1) % 3;
    e[k] = {int64_t(t.x[n]) - t.x[k], int64_t(t.y[n]) - t.y[k], t.x[k], t.y[k], 0};
    e[k].bias = e[k].dy < 0 || (e[k].dy == 0 && e[k].dx > 0) ? 0 : 1;  // pixels on a top or left edge belong to the triangle
  }
  for (int y = box.y0; y <= box.y1; ++y) {
    int64_t lo = box.x0, hi = box.x1;
    for (const Edge& g : e) {
      // E(px) = slope * px + c >= 0
      const int64_t slope = -g.dy * subpixels;
      const int64_t c = g.dx * (int64_t(y) * subpixels + subpixels / 2 - g.y) - g.dy * (subpixels / 2 - g.x) - g.bias;
      if (slope == 0) {
        if (c < 0) hi = lo - 1;
      } else if (slope > 0) {
        if (c + slope * lo < 0) lo = (-c + slope - 1) / slope;  // -c > slope*lo >= 0
      } else {
        if (c + slope * hi < 0) hi = c >= 0 ? c / -slope : int64_t(-1);
      }
    }
    if (lo <= hi) f(y, int(lo), int(hi));
  }
}

/// The plane of w over the picture, anchored at a vertex.
struct WPlane {
  double at, gx, gy, x, y;
  float lo, hi;
  double operator()(int px, int py) const { return at + gx * (px + 0.5 - x) + gy * (py + 0.5 - y); }
};
WPlane w_plane(const TriangleRecord& t);
/// Depth of n pixels of a row from (x, y): 1/w or w, held within the triangle's own range.
void span_depths(const WPlane& plane, bool parallel, int x, int y, int n, float* depth);

/// Draws one large triangle into the pixels of `box`; only one thread may work on them.
void draw_record(const TriangleRecord& t, const PixelBox& box, bool parallel, uint64_t* keys, int width);

}  // namespace sg::raster
