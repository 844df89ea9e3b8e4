// SPDX-License-Identifier: Apache-2.0
// Instanced triangles to visibility keys, and the light on them. No fused multiply-add: every target gives the same bits.
//
//   glyph --(its points, one a lane)--> points on the pixel grid, of many glyphs --(triangles, one a lane)--> those that face the viewer
//   and hold a pixel's centre, in a list --(full vectors of them)--> keys
#include "render/raster/glyphs/glyphs.h"

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/raster/glyphs/glyphs_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/raster/triangles/small_triangles-inl.h"
#include "render/shade/light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::raster::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

/// Points of glyphs on the pixel grid, and the triangles among them that wait to be drawn.
struct GlyphQueue {
  static constexpr size_t room = 2048, waiting = 1024;
  std::vector<int32_t> x, y, corner[3], primitive;
  std::vector<float> w;
  PixelQueue pixels;
  size_t points = 0, triangles = 0;

  GlyphQueue() : x(room), y(room), primitive(waiting + 64), w(room) {
    for (auto& c : corner) c.resize(waiting + 64);
  }
};

void draw_queue(const GlyphJob& job, GlyphQueue& q) {
  const DF d;
  const DI di;
  const size_t lanes = hn::Lanes(d);
  for (size_t t = 0; t < q.triangles; t += lanes) {
    Corner c[3];
    const MI real = hn::FirstN(di, q.triangles - t);
    for (int k = 0; k < 3; ++k) {
      const I at = only(real, hn::LoadU(di, &q.corner[k][t]));
      c[k].x = hn::GatherIndex(di, q.x.data(), at), c[k].y = hn::GatherIndex(di, q.y.data(), at);
      c[k].w = hn::GatherIndex(d, q.w.data(), at);
    }
    Setup s;
    I lx, hx, ly, hy;
    pixel_boxes(job.view, c, s, lx, hx, ly, hy);
    const MI live = turn(c, s, real);
    draw_thin(job.view, job.keys, s, live, hn::LoadU(di, &q.primitive[t]), q.pixels);
  }
  q.pixels.flush(job.keys);
  q.triangles = q.points = 0;
}

/// Box of a glyph on the pixel grid.
struct GlyphBox {
  int32_t lx, hx, ly, hy;
};

/// The points of a glyph go behind those in the queue; false when it must be clipped.
HWY_INLINE bool project_glyph(const EyeView& v, const GlyphShape& s, const float* m, GlyphQueue& q, GlyphBox& box) {
  const DF d;
  const DI di;
  const size_t lanes = hn::Lanes(d);
  I lx = set(di, INT32_MAX), ly = lx, hx = set(di, INT32_MIN), hy = hx;
  M clean = hn::FirstN(d, lanes);
  const F near_plane = set(d, v.near_plane), guard = set(d, guard_band), scale = set(d, v.scale), grid = set(d, float(subpixels));
  for (size_t k = 0; k < s.points; k += lanes) {
    const F x = hn::LoadU(d, &s.x[k]), y = hn::LoadU(d, &s.y[k]), z = hn::LoadU(d, &s.z[k]);
    auto row = [&](int r) { return ((m[4 * r] * x + m[4 * r + 1] * y) + m[4 * r + 2] * z) + m[4 * r + 3]; };
    // The eye's coordinates; hi + lo is the eye in two floats.
    const F dx = (row(0) - v.hi[0]) - v.lo[0], dy = (row(1) - v.hi[1]) - v.lo[1], dz = (row(2) - v.hi[2]) - v.lo[2];
    auto along = [&](const float* a) { return dx * a[0] + dy * a[1] + dz * a[2]; };
    F ex = along(v.right), ey = along(v.up), w = along(v.forward);
    clean = clean & (w >= near_plane);
    if (!v.parallel) w = 1.0f / w, ex = ex * w, ey = ey * w;
    // On the picture, in subpixels.
    const F px = v.center_x + ex * scale, py = v.center_y - ey * scale;
    clean = clean & ((abs(px) < guard) & (abs(py) < guard));
    const I ix = nearest_int(px * grid), iy = nearest_int(py * grid);
    lx = min(lx, ix), hx = max(hx, ix), ly = min(ly, iy), hy = max(hy, iy);
    hn::StoreU(ix, di, &q.x[q.points + k]), hn::StoreU(iy, di, &q.y[q.points + k]), hn::StoreU(w, d, &q.w[q.points + k]);
  }
  auto least = [](I a) { return hn::GetLane(hn::MinOfLanes(DI(), a)); };
  auto most = [](I a) { return hn::GetLane(hn::MaxOfLanes(DI(), a)); };
  box = {least(lx), most(hx), least(ly), most(hy)};
  return all(clean);
}

void keep_large(const GlyphJob& job, const GlyphShape& s, const GlyphQueue& q, size_t t, uint64_t bits, uint32_t first,
                std::vector<TriangleRecord>& large) {
  for (; bits; bits &= bits - 1) {
    const size_t i = t + size_t(__builtin_ctzll(bits));
    TriangleRecord r;
    for (size_t k = 0; k < 3; ++k) {
      const size_t p = q.points + size_t(s.corners[k][i]);
      r.x[k] = q.x[p], r.y[k] = q.y[p], r.w[k] = q.w[p];
    }
    r.primitive = first + uint32_t(i);
    if (finish_record(r, job.view.width, job.view.height)) large.push_back(r);
  }
}

/// Triangles of the glyph whose points lie behind those in the queue. `front`: sign of the area of faces that are seen; 0: all are.
HWY_INLINE void queue_triangles(const GlyphJob& job, const GlyphShape& s, uint32_t first, int front, bool all_small, GlyphQueue& q,
                                std::vector<TriangleRecord>& large) {
  const DF d;
  const DI di;
  const size_t lanes = hn::Lanes(d);
  const I base = set(di, int32_t(q.points)), zero = set(di, 0), limit = set(di, job.small * subpixels);
  const int32_t *xs = &q.x[q.points], *ys = &q.y[q.points];
  for (size_t t = 0; t < s.triangles; t += lanes) {
    Corner c[3];
    I number[3];
    for (int k = 0; k < 3; ++k) {
      number[k] = hn::LoadU(di, &s.corners[k][t]);
      c[k].x = hn::GatherIndex(di, xs, number[k]), c[k].y = hn::GatherIndex(di, ys, number[k]);
    }
    Setup b;
    I lx, hx, ly, hy;
    pixel_boxes(job.view, c, b, lx, hx, ly, hy);
    const MI none = (b.first_x > b.last_x) | (b.first_y > b.last_y);
    MI seen = hn::FirstN(di, s.triangles - t) & !none;
    if (!all_small) {
      const MI small = (hx - lx < limit) & (hy - ly < limit), big = seen & !small;
      if (any(big)) keep_large(job, s, q, t, bits_of(di, big), first, large);
      seen = small & seen;
    }
    const I area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[1].y - c[0].y) * (c[2].x - c[0].x);
    seen = seen & (front > 0 ? area > zero : front < 0 ? area < zero : area != zero);
    const size_t n = compress_store(di, number[0] + base, seen, &q.corner[0][q.triangles]);
    compress_store(di, number[1] + base, seen, &q.corner[1][q.triangles]);
    compress_store(di, number[2] + base, seen, &q.corner[2][q.triangles]);
    compress_store(di, hn::Iota(di, int32_t(first + uint32_t(t))), seen, &q.primitive[q.triangles]);
    q.triangles += n;
    if (q.triangles + lanes > GlyphQueue::waiting) {
      const size_t points = q.points;
      draw_queue(job, q);
      q.points = points;
    }
  }
}

void draw_glyph_range(const GlyphJob& job, size_t begin, size_t end, std::vector<TriangleRecord>& large) {
  const EyeView& v = job.view;
  const size_t lanes = hn::Lanes(DF());
  GlyphQueue q;
  for (size_t k = begin; k < end; ++k) {
    const size_t i = job.set->order ? (*job.set->order)[k] : k;
    if (job.set->order && k + 12 < end) {
      const float* later = job.set->instances->data() + 12 * size_t((*job.set->order)[k + 12]);
      __builtin_prefetch(later), __builtin_prefetch(later + 11);
    }
    float m[12];
    if (!glyph_matrix(*job.set, v, job.pixel_scale, i, m)) continue;
    const GlyphShape& s = job.set->shape_of(i);
    if (s.triangles == 0) continue;
    const size_t more = (s.points + lanes - 1) / lanes * lanes;
    if (q.points + more > q.x.size()) {
      draw_queue(job, q);
      if (more > q.x.size()) q.x.resize(more), q.y.resize(more), q.w.resize(more);
    }
    GlyphBox box;
    const uint32_t first = job.first_primitive + uint32_t(i << job.set->shift);
    if (!project_glyph(v, s, m, q, box)) {
      draw_glyphs_reference(job, k, k + 1, large);
      continue;
    }
    // The pixels whose centres lie in its box, if any.
    constexpr int half = subpixels / 2;
    if (std::max((box.lx + half - 1) >> 8, 0) > std::min((box.hx - half) >> 8, v.width - 1) ||
        std::max((box.ly + half - 1) >> 8, 0) > std::min((box.hy - half) >> 8, v.height - 1))
      continue;
    int front = 0;
    if (job.cull && s.closed) {
      const float det = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]);
      front = det > 0 ? -1 : det < 0 ? 1 : 0;  // rows run down the picture
    }
    const int limit = job.small * subpixels;
    queue_triangles(job, s, first, front, box.hx - box.lx < limit && box.hy - box.ly < limit, q, large);
    q.points += more;
  }
  draw_queue(job, q);
}

void light_glyph_batch(const GlyphLight& job, ShadeBatch& b) {
  const DF d;
  const DI di;
  const EyeView& v = job.view;
  const size_t lanes = hn::Lanes(d);
  const F inverse = set(d, 1.0f / v.scale), half = set(d, 0.5f);
  const float* faces = job.set.faces.data();
  const auto* matrices = job.set.instances->data();
  while (b.n % lanes) b.pixel[b.n] = b.pixel[b.n - 1], b.triangle[b.n] = b.triangle[b.n - 1], b.depth[b.n] = b.depth[b.n - 1], ++b.n;
  HWY_ALIGN int32_t rows[hn::MaxLanes(DI())];
  for (size_t i = 0; i < b.n; i += lanes) {
    const I pixel = hn::Load(di, reinterpret_cast<const int32_t*>(b.pixel + i));
    const auto primitive = hn::Load(DU(), b.triangle + i);
    const I instance = bit_cast(di, hn::ShiftRightSame(primitive, job.set.shift));
    for (size_t k = 0; k < lanes; ++k) rows[k] = job.set.row_of(b.triangle[i + k]) * int32_t(GlyphShape::row);
    const I row = hn::Load(di, rows);
    // Where the pixel's ray is at the depth that is seen, from the eye.
    const F px = convert(d, (pixel & (tile_size - 1)) + b.tile_x) + half;
    const F py = convert(d, shift_right<6>(pixel) + b.tile_y) + half;
    const V3 side = set3(v.right) * ((px - v.center_x) * inverse) + set3(v.up) * ((v.center_y - py) * inverse);
    const V3 forward = set3(v.forward), ray = v.parallel ? forward : forward + side;
    const F depth = hn::Load(d, b.depth + i);
    const V3 hit = v.parallel ? side + forward * depth : ray * depth;
    // The matrix, by columns, made near 1.
    const I at = shift_left<2>(instance) + shift_left<3>(instance);
    auto number = [&](int k) { return hn::GatherIndex(d, matrices + k, at); };
    V3 a{number(0), number(4), number(8)}, e{number(1), number(5), number(9)}, c{number(2), number(6), number(10)};
    const V3 place = (V3{number(3), number(7), number(11)} - set3(v.hi)) - set3(v.lo);
    F size = set(d, 0);
    for (const V3& q : {a, e, c}) size = max(size, max(abs(q.x), max(abs(q.y), abs(q.z))));
    const F unscale = 1.0f / size;
    a = a * unscale, e = e * unscale, c = c * unscale;
    // Rows of the inverse, times the determinant; normals turn by the same vectors.
    const V3 ka = cross3(e, c), ke = cross3(c, a), kc = cross3(a, e);
    auto face_number = [&](int k) { return hn::GatherIndex(d, faces + k, row); };
    auto to_world = [&](F x, F y, F z) { return ka * x + ke * y + kc * z; };
    // Normals: of the face, and the smooth one at the place in the glyph's own coordinates.
    const V3 normal = to_world(face_number(0), face_number(1), face_number(2));
    auto smooth = [&](V3 face) {
      if (!job.set.smooth) return face;
      F drawn = size;
      if (job.set.in_pixels) {
        const F unit_length = set(d, job.pixel_scale / v.scale);
        drawn = size * (v.parallel ? unit_length : unit_length * dot3(place, forward));
      }
      const F det = dot3(a, ka), per = 1.0f / (det * drawn);
      const V3 offset = hit - place;
      const M flat = !(abs(per) < 1e30f);
      auto local = [&](V3 k) { return only(!flat, dot3(k, offset) * per); };
      const F x = local(ka), y = local(ke), z = local(kc);
      auto linear = [&](int r) {
        return face_number(3 + r) + face_number(6 + 3 * r) * x + face_number(7 + 3 * r) * y + face_number(8 + 3 * r) * z;
      };
      return lit_side(to_world(linear(0), linear(1), linear(2)), face);
    };
    F light, gloss;
    light_up(job.material, job.lights, ray, normal, smooth, light, gloss);
    hn::Store(light, d, b.light + i), hn::Store(gloss, d, b.gloss + i);
  }
}

}  // namespace sg::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::raster {

HWY_EXPORT(draw_glyph_range);
HWY_EXPORT(light_glyph_batch);

void draw_glyphs(const GlyphJob& job, size_t begin, size_t end, std::vector<TriangleRecord>& large) {
  HWY_DYNAMIC_DISPATCH(draw_glyph_range)(job, begin, end, large);
}

void light_glyphs(const GlyphLight& job, ShadeBatch& b) {
  const size_t n = b.n;
  if (n == 0) return;
  HWY_DYNAMIC_DISPATCH(light_glyph_batch)(job, b);
  b.n = n;
}

}  // namespace sg::raster
#endif
