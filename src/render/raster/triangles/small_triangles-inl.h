// SPDX-License-Identifier: Apache-2.0
// Triangles of a few pixels, one a vector lane, for files that are compiled once for each target and have included Highway. Inside
// render/raster only. No fused multiply-add: every target gives the same bits.
#if defined(SG_RASTER_SMALL_TRIANGLES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_RASTER_SMALL_TRIANGLES_INL
#undef SG_RASTER_SMALL_TRIANGLES_INL
#else
#define SG_RASTER_SMALL_TRIANGLES_INL
#endif
#include "base/compress-inl.h"
#include "base/simd/vector-inl.h"
#include "render/raster/triangles/kernels.h"

HWY_BEFORE_NAMESPACE();
namespace sg::raster::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;
using sg::HWY_NAMESPACE::compress_store;

using DF = hn::ScalableTag<float>;
using DI = hn::RebindToSigned<DF>;
using DU = hn::RebindToUnsigned<DF>;
using F = hn::Vec<DF>;
using I = hn::Vec<DI>;
using M = hn::Mask<DF>;
using MI = hn::Mask<DI>;

struct Corner {
  I x, y;
  F w, px, py, z;
};

HWY_INLINE I min3(I a, I b, I c) { return min(a, min(b, c)); }
HWY_INLINE I max3(I a, I b, I c) { return max(a, max(b, c)); }

struct Setup {
  I e[3], step_x[3], step_y[3], above[3];
  I first_x, first_y, last_x, last_y;
  F w[3], inverse_area;
};

template <class Mask, class D>
HWY_INLINE uint64_t bits_of(D d, Mask m) {
  uint8_t bytes[16] = {};
  hn::StoreMaskBits(d, m, bytes);
  uint64_t bits;
  __builtin_memcpy(&bits, bytes, 8);
  const size_t lanes = hn::Lanes(d);
  return lanes < 64 ? bits & ((uint64_t(1) << lanes) - 1) : bits;
}

/// Draws the lanes of `live` into the keys: all their boxes are walked together, pixel by pixel. primitive(k): number of that in lane k.
template <class Primitive>
HWY_INLINE void draw_small(const EyeView& view, uint64_t* keys, const Setup& s, MI live, Primitive&& primitive) {
  const DF d;
  const DI di;
  const int wide = hn::GetLane(hn::MaxOfLanes(di, only(live, (s.last_x - s.first_x) + 1)));
  const int high = hn::GetLane(hn::MaxOfLanes(di, only(live, (s.last_y - s.first_y) + 1)));
  alignas(64) float depth[64];
  alignas(64) int32_t fx[64], fy[64];
  hn::Store(s.first_x, di, fx), hn::Store(s.first_y, di, fy);
  const I most_x = s.last_x - s.first_x, most_y = s.last_y - s.first_y;
  I row0 = s.e[0], row1 = s.e[1], row2 = s.e[2];
  for (int j = 0; j < high; ++j) {
    I e0 = row0, e1 = row1, e2 = row2;
    const MI in_row = live & !(j > most_y);
    for (int i = 0; i < wide; ++i) {
      const MI inside = (e0 > s.above[0]) & (e1 > s.above[1]) & ((e2 > s.above[2]) & (in_row & !(i > most_x)));
      if (any(inside)) {
        // Weights of the corners are the opposite edge functions.
        F w = (convert(d, e1) * s.w[0] + convert(d, e2) * s.w[1] + convert(d, e0) * s.w[2]) * s.inverse_area;
        if (!view.parallel) w = 1.0f / w;
        hn::Store(w, d, depth);
        for (uint64_t bits = bits_of(di, inside); bits; bits &= bits - 1) {
          const int k = __builtin_ctzll(bits);
          keep_nearer(keys + size_t(fy[k] + j) * size_t(view.width) + size_t(fx[k] + i), depth_key(depth[k], primitive(k)));
        }
      }
      e0 = e0 + s.step_x[0], e1 = e1 + s.step_x[1], e2 = e2 + s.step_x[2];
    }
    row0 = row0 + s.step_y[0], row1 = row1 + s.step_y[1], row2 = row2 + s.step_y[2];
  }
}

/// Pixels waiting to be written to the keys, so that accesses far apart in memory are issued together.
struct PixelQueue {
  static constexpr size_t full = 128;
  alignas(64) int32_t pixel[full + 64], primitive[full + 64];
  alignas(64) float depth[full + 64];
  size_t count = 0;

  void flush(uint64_t* keys) {
    for (size_t i = 0; i < count; ++i) __builtin_prefetch(keys + pixel[i], 1);
    for (size_t i = 0; i < count; ++i) keep_nearer(keys + pixel[i], depth_key(depth[i], uint32_t(primitive[i])));
    count = 0;
  }
};

/// As draw_small(), for long thin triangles: in each row the lanes begin where their triangles do and go as far as the longest.
HWY_INLINE void draw_thin(const EyeView& view, uint64_t* keys, const Setup& s, MI live, I primitive, PixelQueue& out) {
  const DF d;
  const DI di;
  const I one = set(di, 1), zero = set(di, 0), width = set(di, view.width);
  const int high = hn::GetLane(hn::MaxOfLanes(di, only(live, (s.last_y - s.first_y) + one)));
  const I most_y = s.last_y - s.first_y;
  I first = s.first_y * width + s.first_x;
  const F most_x = convert(d, s.last_x - s.first_x), hair = set(d, 1e-3f);  // what is inside is decided by whole numbers
  // Edge functions of the first row; where along a row each changes its sign.
  I row[3] = {s.e[0], s.e[1], s.e[2]};
  F inverse[3];
  M rises[3], falls[3];
  for (int k = 0; k < 3; ++k) {
    inverse[k] = -1.0f / convert(d, s.step_x[k]);
    rises[k] = rebind(d, s.step_x[k] > zero), falls[k] = rebind(d, s.step_x[k] < zero);
  }
  for (int j = 0; j < high; ++j, first = first + width) {
    // The span of each lane in this row.
    F from = set(d, 0), to = most_x;
    for (int k = 0; k < 3; ++k) {
      const F crossing = convert(d, row[k] - s.above[k] - one) * inverse[k];
      from = select(rises[k], max(from, ceil(crossing - hair)), from);
      to = select(falls[k], min(to, floor(crossing + hair)), to);
    }
    const M some = (from <= to) & rebind(d, live & !(j > most_y));
    if (any(some)) {
      // Pixel by pixel, inside as decided by whole numbers.
      const I start = convert(di, only(some, from)), wide = convert(di, only(some, to - from));
      const MI drawn = rebind(di, some);
      const int most = hn::GetLane(hn::MaxOfLanes(di, wide));
      I e0 = row[0] + s.step_x[0] * start, e1 = row[1] + s.step_x[1] * start, e2 = row[2] + s.step_x[2] * start, at = first + start;
      for (int i = 0; i <= most; ++i) {
        const MI inside = (e0 > s.above[0]) & (e1 > s.above[1]) & ((e2 > s.above[2]) & (drawn & !(i > wide)));
        if (any(inside)) {
          F w = (convert(d, e1) * s.w[0] + convert(d, e2) * s.w[1] + convert(d, e0) * s.w[2]) * s.inverse_area;
          if (!view.parallel) w = 1.0f / w;
          const size_t more = compress_store(di, at, inside, out.pixel + out.count);
          compress_store(di, primitive, inside, out.primitive + out.count);
          compress_store(d, w, rebind(d, inside), out.depth + out.count);
          out.count += more;
          if (out.count >= PixelQueue::full) out.flush(keys);
        }
        e0 = e0 + s.step_x[0], e1 = e1 + s.step_x[1], e2 = e2 + s.step_x[2], at = at + one;
      }
    }
    for (int k = 0; k < 3; ++k) row[k] = row[k] + s.step_y[k];
  }
}

HWY_INLINE void edge(const Corner& a, const Corner& b, I px, I py, Setup& s, int k) {
  const DI di;
  const I dx = b.x - a.x, dy = b.y - a.y;
  s.e[k] = dx * (py - a.y) - dy * (px - a.x);
  s.step_x[k] = -shift_left<8>(dy), s.step_y[k] = shift_left<8>(dx);
  const I zero = set(di, 0);
  const MI owns = (dy < zero) | ((dy == zero) & (dx > zero));
  s.above[k] = select(owns, -1, zero);
}

/// The pixels whose centres lie in the boxes of the triangles, within the picture. lx..hy: the boxes on the pixel grid.
HWY_INLINE void pixel_boxes(const EyeView& view, const Corner* c, Setup& s, I& lx, I& hx, I& ly, I& hy) {
  const DI di;
  lx = min3(c[0].x, c[1].x, c[2].x), hx = max3(c[0].x, c[1].x, c[2].x);
  ly = min3(c[0].y, c[1].y, c[2].y), hy = max3(c[0].y, c[1].y, c[2].y);
  const I half = set(di, subpixels / 2), zero = set(di, 0);
  s.first_x = max(shift_right<8>(lx + (half - 1)), zero), s.first_y = max(shift_right<8>(ly + (half - 1)), zero);
  s.last_x = min(shift_right<8>(hx - half), view.width - 1), s.last_y = min(shift_right<8>(hy - half), view.height - 1);
}

/// Turns the triangles of `small` so that their inside is positive; which of them have an area.
HWY_INLINE MI turn(Corner* c, Setup& s, MI small) {
  const DF d;
  const DI di;
  const I zero = set(di, 0), half = set(di, subpixels / 2);
  const I area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[1].y - c[0].y) * (c[2].x - c[0].x);
  const MI turned = area < zero;
  const Corner b = c[1];
  c[1].x = select(turned, c[2].x, b.x), c[2].x = select(turned, b.x, c[2].x);
  c[1].y = select(turned, c[2].y, b.y), c[2].y = select(turned, b.y, c[2].y);
  const M turned_f = rebind(d, turned);
  c[1].w = select(turned_f, c[2].w, b.w), c[2].w = select(turned_f, b.w, c[2].w);
  const MI live = small & !(area == zero);
  const I px = shift_left<8>(s.first_x) + half, py = shift_left<8>(s.first_y) + half;
  edge(c[0], c[1], px, py, s, 0), edge(c[1], c[2], px, py, s, 1), edge(c[2], c[0], px, py, s, 2);
  for (int k = 0; k < 3; ++k) s.w[k] = c[k].w;
  s.inverse_area = 1.0f / convert(d, abs(area));
  return live;
}

}  // namespace sg::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
