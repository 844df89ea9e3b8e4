// SPDX-License-Identifier: Apache-2.0
// Triangles to visibility keys, one triangle per vector lane. No fused multiply-add: every target gives the same bits.
#include "render/raster/triangles/kernels.h"

#include <algorithm>

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/raster/triangles/triangles_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/raster/triangles/small_triangles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::raster::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

HWY_INLINE Corner project(const TriangleJob& job, I point) {
  const DF d;
  const EyeView& v = job.view;
  const I at = point + (point + point);
  const F x = hn::GatherIndex(d, job.xyz, at), y = hn::GatherIndex(d, job.xyz + 1, at), z = hn::GatherIndex(d, job.xyz + 2, at);
  const F dx = (x - v.hi[0]) - v.lo[0];
  const F dy = (y - v.hi[1]) - v.lo[1];
  const F dz = (z - v.hi[2]) - v.lo[2];
  // The eye's coordinates.
  auto along = [&](const float* a) { return dx * a[0] + dy * a[1] + dz * a[2]; };
  F ex = along(v.right), ey = along(v.up);
  Corner c;
  c.z = along(v.forward);
  if (v.parallel) {
    c.w = c.z;
  } else {
    c.w = 1.0f / c.z;
    ex = ex * c.w, ey = ey * c.w;
  }
  // On the picture, then on the grid of subpixels.
  const F scale = set(d, v.scale), grid = set(d, float(subpixels));
  c.px = v.center_x + ex * scale;
  c.py = v.center_y - ey * scale;
  c.x = nearest_int(c.px * grid), c.y = nearest_int(c.py * grid);
  return c;
}

struct Lanes {
  alignas(64) int32_t x[3][64], y[3][64];
  alignas(64) float w[3][64];
};

void store_large(const Corner* c, uint64_t bits, uint32_t first, const EyeView& view, std::vector<TriangleRecord>& large) {
  const DF d;
  const DI di;
  Lanes l;
  for (int k = 0; k < 3; ++k) hn::Store(c[k].x, di, l.x[k]), hn::Store(c[k].y, di, l.y[k]), hn::Store(c[k].w, d, l.w[k]);
  for (; bits; bits &= bits - 1) {
    const int i = __builtin_ctzll(bits);
    TriangleRecord t;
    for (int k = 0; k < 3; ++k) t.x[k] = l.x[k][i], t.y[k] = l.y[k][i], t.w[k] = l.w[k][i];
    t.primitive = first + uint32_t(i);
    if (finish_record(t, view.width, view.height)) large.push_back(t);
  }
}

HWY_INLINE void draw_block(const TriangleJob& job, const uint32_t* t, size_t count, size_t triangle, std::vector<TriangleRecord>& large) {
  const DF d;
  const DI di;
  const DU du;
  const EyeView& view = job.view;
  hn::Vec<DU> i0, i1, i2;
  hn::LoadInterleaved3(du, t, i0, i1, i2);
  Corner c[3] = {project(job, bit_cast(di, i0)), project(job, bit_cast(di, i1)), project(job, bit_cast(di, i2))};

  // Which triangles can be seen, and which need clipping? Comparisons with NaN are false, so those end up with the clipped ones.
  const MI real = hn::FirstN(di, count);
  const F near_plane = set(d, view.near_plane), guard = set(d, guard_band);
  auto clean = [&](const Corner& q) { return (q.z >= near_plane) & ((abs(q.px) < guard) & (abs(q.py) < guard)); };
  const MI whole = rebind(di, clean(c[0]) & (clean(c[1]) & clean(c[2]))) & real;
  const MI behind = rebind(di, (c[0].z < near_plane) & ((c[1].z < near_plane) & (c[2].z < near_plane)));
  const uint32_t first = job.first_primitive + uint32_t(triangle);
  for (uint64_t bits = bits_of(di, real & !(whole | behind)); bits; bits &= bits - 1) {
    const size_t k = size_t(__builtin_ctzll(bits));
    clip_triangle(view, job.xyz + 3 * size_t(t[3 * k]), job.xyz + 3 * size_t(t[3 * k + 1]), job.xyz + 3 * size_t(t[3 * k + 2]),
                  first + uint32_t(k), large);
  }

  // Pixels whose centres lie in the box; most tiny triangles have none.
  Setup s;
  I lx, hx, ly, hy;
  pixel_boxes(view, c, s, lx, hx, ly, hy);
  const MI no_pixel = (s.first_x > s.last_x) | (s.first_y > s.last_y);
  const MI seen = whole & !no_pixel;
  if (none(seen)) return;
  const I limit = set(di, job.small * subpixels);
  const MI small = (hx - lx < limit) & (hy - ly < limit) & seen;
  const MI big = seen & !small;
  if (any(big)) store_large(c, bits_of(di, big), first, view, large);
  if (none(small)) return;

  const MI live = turn(c, s, small);
  draw_small(view, job.keys, s, live, [&](int k) { return first + uint32_t(k); });
}

void draw(const TriangleJob& job, size_t begin, size_t end, std::vector<TriangleRecord>& large) {
  const size_t lanes = hn::Lanes(DU());
  size_t i = begin;
  for (; i + lanes <= end; i += lanes) draw_block(job, job.triangles + 3 * i, lanes, i, large);
  if (i == end) return;
  uint32_t rest[3 * 64] = {};
  const size_t count = end - i;
  for (size_t k = 0; k < 3 * lanes; ++k) rest[k] = job.triangles[3 * i + (k < 3 * count ? k : k % 3)];
  draw_block(job, rest, count, i, large);
}

void depths(const WPlane& plane, bool parallel, int x, int y, int n, float* depth) {
  const DF d;
  const DI di;
  const int lanes = int(hn::Lanes(d));
  const F start = set(d, float(plane(x, y))), slope = set(d, float(plane.gx)), lo = set(d, plane.lo), hi = set(d, plane.hi);
  for (int i = 0; i < n; i += lanes) {
    const F at = convert(d, hn::Iota(di, i));
    F w = min(max(start + slope * at, lo), hi);
    if (!parallel) w = 1.0f / w;
    hn::StoreU(w, d, depth + i);
  }
}

}  // namespace sg::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::raster {

HWY_EXPORT(draw);
HWY_EXPORT(depths);

void draw_triangles(const TriangleJob& job, size_t begin, size_t end, std::vector<TriangleRecord>& large) {
  HWY_DYNAMIC_DISPATCH(draw)(job, begin, end, large);
}

void span_depths(const WPlane& plane, bool parallel, int x, int y, int n, float* depth) {
  HWY_DYNAMIC_DISPATCH(depths)(plane, parallel, x, y, n, depth);
}

void draw_record(const TriangleRecord& t, const PixelBox& box, bool parallel, uint64_t* keys, int width) {
  const WPlane plane = w_plane(t);
  for_each_span(t, box, [&](int y, int x0, int x1) {
    alignas(64) float depth[256];
    uint64_t* row = keys + size_t(y) * size_t(width);
    for (int x = x0; x <= x1; x += 128) {
      const int n = std::min(x1 - x + 1, 128);
      span_depths(plane, parallel, x, y, n, depth);
      for (int i = 0; i < n; ++i) {
        const uint64_t key = depth_key(depth[i], t.primitive);
        row[x + i] = key < row[x + i] ? key : row[x + i];
      }
    }
  });
}

/// One triangle at a time, in plain C++: what the vector code is compared with.
void draw_triangles_reference(const TriangleJob& job, size_t begin, size_t end, std::vector<TriangleRecord>& large) {
  const EyeView& v = job.view;
  for (size_t i = begin; i < end; ++i) {
    const uint32_t primitive = job.first_primitive + uint32_t(i);
    TriangleRecord t;
    t.primitive = primitive;
    const float* p[3];
    bool whole = true, behind = true;
    for (int k = 0; k < 3; ++k) {
      p[k] = job.xyz + 3 * size_t(job.triangles[3 * i + size_t(k)]);
      const EyePoint e = to_eye(v, p[k]);
      const float w = v.parallel ? e.z : 1.0f / e.z;
      const float px = v.center_x + (v.parallel ? e.x : e.x * w) * v.scale, py = v.center_y - (v.parallel ? e.y : e.y * w) * v.scale;
      const bool clean = e.z >= v.near_plane && std::abs(px) < guard_band && std::abs(py) < guard_band;
      whole = whole && clean, behind = behind && e.z < v.near_plane;
      if (clean)
        t.x[k] = int32_t(std::nearbyint(px * float(subpixels))), t.y[k] = int32_t(std::nearbyint(py * float(subpixels))), t.w[k] = w;
    }
    if (!whole) {
      if (!behind) clip_triangle(v, p[0], p[1], p[2], primitive, large);
      continue;
    }
    const int wide = std::max({t.x[0], t.x[1], t.x[2]}) - std::min({t.x[0], t.x[1], t.x[2]}),
              high = std::max({t.y[0], t.y[1], t.y[2]}) - std::min({t.y[0], t.y[1], t.y[2]});
    if (!finish_record(t, v.width, v.height)) continue;
    if (wide >= job.small * subpixels || high >= job.small * subpixels) {
      large.push_back(t);
      continue;
    }
    auto twice = [&](int a, int b, int x, int y) { return (t.x[b] - t.x[a]) * (y - t.y[a]) - (t.y[b] - t.y[a]) * (x - t.x[a]); };
    const float inverse_area = 1.0f / float(twice(0, 1, t.x[2], t.y[2]));
    for_each_span(t, pixel_box(t, v.width, v.height), [&](int y, int x0, int x1) {
      for (int x = x0; x <= x1; ++x) {
        const int cx = x * subpixels + subpixels / 2, cy = y * subpixels + subpixels / 2;
        float w = (float(twice(1, 2, cx, cy)) * t.w[0] + float(twice(2, 0, cx, cy)) * t.w[1] + float(twice(0, 1, cx, cy)) * t.w[2]) *
                  inverse_area;
        if (!v.parallel) w = 1.0f / w;
        keep_nearer(job.keys + size_t(y) * size_t(v.width) + size_t(x), depth_key(w, primitive));
      }
    });
  }
}

}  // namespace sg::raster
#endif
