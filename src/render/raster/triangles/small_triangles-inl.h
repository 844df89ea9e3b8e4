// SPDX-License-Identifier: Apache-2.0
// Triangles of a few pixels, one a vector lane, for files that are compiled once for each target and have included Highway. Inside
// render/raster only. No fused multiply-add: every target gives the same bits.
#if defined(SG_RASTER_SMALL_TRIANGLES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_RASTER_SMALL_TRIANGLES_INL
#undef SG_RASTER_SMALL_TRIANGLES_INL
#else
#define SG_RASTER_SMALL_TRIANGLES_INL
#endif
#include "base/compress_inl.h"
#include "render/raster/triangles/kernels.h"

HWY_BEFORE_NAMESPACE();
namespace sg::raster::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
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

HWY_INLINE I min3(I a, I b, I c) { return hn::Min(a, hn::Min(b, c)); }
HWY_INLINE I max3(I a, I b, I c) { return hn::Max(a, hn::Max(b, c)); }

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
  const int wide = hn::GetLane(hn::MaxOfLanes(di, hn::IfThenElseZero(live, (s.last_x - s.first_x) + hn::Set(di, 1))));
  const int high = hn::GetLane(hn::MaxOfLanes(di, hn::IfThenElseZero(live, (s.last_y - s.first_y) + hn::Set(di, 1))));
  alignas(64) float depth[64];
  alignas(64) int32_t fx[64], fy[64];
  hn::Store(s.first_x, di, fx), hn::Store(s.first_y, di, fy);
  const I most_x = s.last_x - s.first_x, most_y = s.last_y - s.first_y;
  I row0 = s.e[0], row1 = s.e[1], row2 = s.e[2];
  for (int j = 0; j < high; ++j) {
    I e0 = row0, e1 = row1, e2 = row2;
    const MI in_row = hn::AndNot(hn::Gt(hn::Set(di, j), most_y), live);
    for (int i = 0; i < wide; ++i) {
      const MI inside = hn::And(hn::And(hn::Gt(e0, s.above[0]), hn::Gt(e1, s.above[1])),
                                hn::And(hn::Gt(e2, s.above[2]), hn::AndNot(hn::Gt(hn::Set(di, i), most_x), in_row)));
      if (!hn::AllFalse(di, inside)) {
        // Weights of the corners are the opposite edge functions.
        F w = (hn::ConvertTo(d, e1) * s.w[0] + hn::ConvertTo(d, e2) * s.w[1] + hn::ConvertTo(d, e0) * s.w[2]) * s.inverse_area;
        if (!view.parallel) w = hn::Set(d, 1.0f) / w;
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

/// Pixels on their way to the keys: what lies far apart in memory is asked for together.
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
  const I one = hn::Set(di, 1), zero = hn::Zero(di), width = hn::Set(di, view.width);
  const int high = hn::GetLane(hn::MaxOfLanes(di, hn::IfThenElseZero(live, (s.last_y - s.first_y) + one)));
  const I most_y = s.last_y - s.first_y;
  I first = s.first_y * width + s.first_x;
  const F most_x = hn::ConvertTo(d, s.last_x - s.first_x), hair = hn::Set(d, 1e-3f);  // what is inside is decided by whole numbers
  I row[3] = {s.e[0], s.e[1], s.e[2]};
  F inverse[3];
  M rises[3], falls[3];
  for (int k = 0; k < 3; ++k) {
    inverse[k] = hn::Set(d, -1.0f) / hn::ConvertTo(d, s.step_x[k]);
    rises[k] = hn::RebindMask(d, hn::Gt(s.step_x[k], zero)), falls[k] = hn::RebindMask(d, hn::Lt(s.step_x[k], zero));
  }
  for (int j = 0; j < high; ++j, first = first + width) {
    F from = hn::Zero(d), to = most_x;
    for (int k = 0; k < 3; ++k) {
      const F crossing = hn::ConvertTo(d, row[k] - s.above[k] - one) * inverse[k];
      from = hn::IfThenElse(rises[k], hn::Max(from, hn::Ceil(crossing - hair)), from);
      to = hn::IfThenElse(falls[k], hn::Min(to, hn::Floor(crossing + hair)), to);
    }
    const M some = hn::And(hn::Le(from, to), hn::RebindMask(d, hn::AndNot(hn::Gt(hn::Set(di, j), most_y), live)));
    if (!hn::AllFalse(d, some)) {
      const I start = hn::ConvertTo(di, hn::IfThenElseZero(some, from)), wide = hn::ConvertTo(di, hn::IfThenElseZero(some, to - from));
      const MI drawn = hn::RebindMask(di, some);
      const int most = hn::GetLane(hn::MaxOfLanes(di, wide));
      I e0 = row[0] + s.step_x[0] * start, e1 = row[1] + s.step_x[1] * start, e2 = row[2] + s.step_x[2] * start, at = first + start;
      for (int i = 0; i <= most; ++i) {
        const MI inside = hn::And(hn::And(hn::Gt(e0, s.above[0]), hn::Gt(e1, s.above[1])),
                                  hn::And(hn::Gt(e2, s.above[2]), hn::AndNot(hn::Gt(hn::Set(di, i), wide), drawn)));
        if (!hn::AllFalse(di, inside)) {
          F w = (hn::ConvertTo(d, e1) * s.w[0] + hn::ConvertTo(d, e2) * s.w[1] + hn::ConvertTo(d, e0) * s.w[2]) * s.inverse_area;
          if (!view.parallel) w = hn::Set(d, 1.0f) / w;
          const size_t more = compress_store(di, at, inside, out.pixel + out.count);
          compress_store(di, primitive, inside, out.primitive + out.count);
          compress_store(d, w, hn::RebindMask(d, inside), out.depth + out.count);
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
  s.step_x[k] = hn::Neg(hn::ShiftLeft<8>(dy)), s.step_y[k] = hn::ShiftLeft<8>(dx);
  const I zero = hn::Zero(di);
  const MI owns = hn::Or(hn::Lt(dy, zero), hn::And(hn::Eq(dy, zero), hn::Gt(dx, zero)));
  s.above[k] = hn::IfThenElse(owns, hn::Set(di, -1), zero);
}

/// The pixels whose centres lie in the boxes of the triangles, within the picture. lx..hy: the boxes on the pixel grid.
HWY_INLINE void pixel_boxes(const EyeView& view, const Corner* c, Setup& s, I& lx, I& hx, I& ly, I& hy) {
  const DI di;
  lx = min3(c[0].x, c[1].x, c[2].x), hx = max3(c[0].x, c[1].x, c[2].x);
  ly = min3(c[0].y, c[1].y, c[2].y), hy = max3(c[0].y, c[1].y, c[2].y);
  const I half = hn::Set(di, subpixels / 2), zero = hn::Zero(di);
  s.first_x = hn::Max(hn::ShiftRight<8>(lx + (half - hn::Set(di, 1))), zero),
  s.first_y = hn::Max(hn::ShiftRight<8>(ly + (half - hn::Set(di, 1))), zero);
  s.last_x = hn::Min(hn::ShiftRight<8>(hx - half), hn::Set(di, view.width - 1)),
  s.last_y = hn::Min(hn::ShiftRight<8>(hy - half), hn::Set(di, view.height - 1));
}

/// Turns the triangles of `small` so that their inside is positive; which of them have an area.
HWY_INLINE MI turn(Corner* c, Setup& s, MI small) {
  const DF d;
  const DI di;
  const I zero = hn::Zero(di), half = hn::Set(di, subpixels / 2);
  const I area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[1].y - c[0].y) * (c[2].x - c[0].x);
  const MI turned = hn::Lt(area, zero);
  const Corner b = c[1];
  c[1].x = hn::IfThenElse(turned, c[2].x, b.x), c[2].x = hn::IfThenElse(turned, b.x, c[2].x);
  c[1].y = hn::IfThenElse(turned, c[2].y, b.y), c[2].y = hn::IfThenElse(turned, b.y, c[2].y);
  const M turned_f = hn::RebindMask(d, turned);
  c[1].w = hn::IfThenElse(turned_f, c[2].w, b.w), c[2].w = hn::IfThenElse(turned_f, b.w, c[2].w);
  const MI live = hn::AndNot(hn::Eq(area, zero), small);
  const I px = hn::ShiftLeft<8>(s.first_x) + half, py = hn::ShiftLeft<8>(s.first_y) + half;
  edge(c[0], c[1], px, py, s, 0), edge(c[1], c[2], px, py, s, 1), edge(c[2], c[0], px, py, s, 2);
  for (int k = 0; k < 3; ++k) s.w[k] = c[k].w;
  s.inverse_area = hn::Set(d, 1.0f) / hn::ConvertTo(d, hn::Abs(area));
  return live;
}

}  // namespace sg::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
