// SPDX-License-Identifier: Apache-2.0
// Deferred shading, one pixel per vector lane. No fused multiply-add and no libm: every target gives the same bits.
#include "render/shade/shade.h"

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/shade/shade_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/shade/light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::raster::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

struct Hit {
  F w[3];  // barycentric
  F depth;
  V3 normal, ray;
};

/// Moeller & Trumbore's ray-triangle test, without the test: the pixel is known to be covered.
HWY_INLINE Hit intersect(const ShadeJob& job, const ShadeBatch& b, I pixel, const I* point) {
  const DF d;
  const EyeView& v = job.view;
  const F inverse = set(d, 1.0f / v.scale), zero = set(d, 0), one = set(d, 1.0f);
  const F px = convert(d, (pixel & (tile_size - 1)) + b.tile_x) + 0.5f;
  const F py = convert(d, shift_right<6>(pixel) + b.tile_y) + 0.5f;
  const V3 side = set3(v.right) * ((px - v.center_x) * inverse) + set3(v.up) * ((v.center_y - py) * inverse);
  const V3 forward = set3(v.forward), none{zero, zero, zero};
  Hit h;
  h.ray = v.parallel ? forward : forward + side;
  const V3 start = v.parallel ? side : none;
  const V3 a = gather3(job.xyz, point[0]), e1 = gather3(job.xyz, point[1]) - a, e2 = gather3(job.xyz, point[2]) - a;
  const V3 ra = (a - set3(v.hi)) - set3(v.lo), t0 = start - ra;
  const V3 p = cross3(h.ray, e2), q = cross3(t0, e1);
  const F inverse_det = one / dot3(e1, p);
  F u = dot3(t0, p) * inverse_det, w = dot3(h.ray, q) * inverse_det;
  // Rounding may leave the triangle by a hair, and a triangle seen edge-on has no answer at all: stay inside.
  const M good = (abs(u) < 1e30f) & (abs(w) < 1e30f);
  u = select(good, max(u, zero), 1.0f / 3), w = select(good, max(w, zero), 1.0f / 3);
  const F sum = max(u + w, one);
  h.w[1] = u / sum, h.w[2] = w / sum, h.w[0] = max(one - h.w[1] - h.w[2], zero);
  h.depth = dot3(ra, forward) + h.w[1] * dot3(e1, forward) + h.w[2] * dot3(e2, forward);
  h.normal = cross3(e1, e2);
  return h;
}

HWY_INLINE void light_up(const ShadeJob& job, const Hit& h, const I* corner, F& light, F& gloss) {
  auto smooth = [&](V3 face) {
    if (!job.normals) return face;
    return lit_side(
        gather3(job.normals, corner[0]) * h.w[0] + gather3(job.normals, corner[1]) * h.w[1] + gather3(job.normals, corner[2]) * h.w[2],
        face);
  };
  light_up(job.material, job.lights, h.ray, h.normal, smooth, light, gloss);
}

/// Number of the table's colour: the rule of ColorTable::at().
HWY_INLINE I table_entry(const ColorSource& c, F stored) {
  const DF d;
  const DI di;
  const int n = int(c.table.size()) - 3;
  const F position = (stored - c.first) * c.slope, zero = set(d, 0), one = set(d, 1.0f);
  const F inside = min(max(position, zero), one);
  I entry = convert(di, inside * float(n - 1) + set(d, 0.5f));
  entry = select(position < zero, n, entry);
  entry = select((stored - c.last) * c.slope > zero, n + 1, entry);
  return select(position == position, entry, n + 2);
}

/// Colour of a lane, or its value in rgba[0] when the scale is not linear.
HWY_INLINE void color(const ShadeJob& job, const Hit& h, I triangle, const I* point, F* rgba) {
  const DF d;
  const DI di;
  const ColorSource& c = *job.color;
  if (c.kind == ColorSource::Kind::constant) {
    for (int k = 0; k < 4; ++k) rgba[k] = set(d, c.constant[k]);
    return;
  }
  // Colours as they are.
  const float* values = c.data();
  I cell = triangle;
  if (c.per_cell)
    cell = job.cells ? hn::GatherIndex(di, reinterpret_cast<const int32_t*>(job.cells), triangle) : triangle + int32_t(job.first_cell);
  if (c.kind == ColorSource::Kind::direct) {
    for (int k = 0; k < 4; ++k) {
      auto value = [&](I at) { return hn::GatherIndex(d, values + k, shift_left<2>(at)); };
      rgba[k] = c.per_cell ? value(cell) : value(point[0]) * h.w[0] + value(point[1]) * h.w[1] + value(point[2]) * h.w[2];
    }
    return;
  }
  // The value: of the cell, of the nearest corner, or between the corners.
  F value;
  if (c.per_cell) value = hn::GatherIndex(d, values, cell);
  else if (c.nearest) {
    I best = select(h.w[1] > h.w[0], point[1], point[0]);
    best = select(h.w[2] > max(h.w[0], h.w[1]), point[2], best);
    value = hn::GatherIndex(d, values, best);
  } else {
    const F v0 = hn::GatherIndex(d, values, point[0]), v1 = hn::GatherIndex(d, values, point[1]), v2 = hn::GatherIndex(d, values, point[2]);
    value = v0 * h.w[0] + v1 * h.w[1] + v2 * h.w[2];
    // Rounding must not push it across an end of the scale that the corners lie on. NaN stays.
    value = select(value == value, min(max(value, min(min(v0, v1), v2)), max(max(v0, v1), v2)), value);
  }
  if (!c.linear) {
    rgba[0] = value;
    return;
  }
  // Its entry of the table of colours.
  const I entry = shift_left<2>(table_entry(c, value));
  const float* table = &c.table[0].x;
  for (int k = 0; k < 4; ++k) rgba[k] = hn::GatherIndex(d, table + k, entry);
}

void run(const ShadeJob& job, ShadeBatch& b) {
  const DF d;
  const DI di;
  const size_t lanes = hn::Lanes(d);
  while (b.n % lanes) b.pixel[b.n] = b.pixel[b.n - 1], b.triangle[b.n] = b.triangle[b.n - 1], ++b.n;
  for (size_t i = 0; i < b.n; i += lanes) {
    const I pixel = hn::Load(di, reinterpret_cast<const int32_t*>(b.pixel + i)),
            triangle = hn::Load(di, reinterpret_cast<const int32_t*>(b.triangle + i));
    const I at = triangle + triangle + triangle;
    I point[3], corner[3];
    for (int k = 0; k < 3; ++k) {
      point[k] = hn::GatherIndex(di, reinterpret_cast<const int32_t*>(job.triangles) + k, at);
      corner[k] = job.corners == job.triangles ? point[k] : hn::GatherIndex(di, reinterpret_cast<const int32_t*>(job.corners) + k, at);
    }
    const Hit h = intersect(job, b, pixel, point);
    F rgba[4] = {set(d, 0), set(d, 0), set(d, 0), set(d, 0)}, light, gloss;
    color(job, h, triangle, point, rgba);
    light_up(job, h, corner, light, gloss);
    hn::Store(h.depth, d, b.depth + i);
    for (int k = 0; k < 4; ++k) hn::Store(rgba[k], d, b.rgba[k] + i);
    hn::Store(light, d, b.light + i), hn::Store(gloss, d, b.gloss + i);
  }
}

}  // namespace sg::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::raster {

HWY_EXPORT(run);

void shade(const ShadeJob& job, ShadeBatch& batch) {
  const size_t n = batch.n;
  if (n == 0) return;
  HWY_DYNAMIC_DISPATCH(run)(job, batch);
  batch.n = n;
  const ColorSource& c = *job.color;
  if (c.kind != ColorSource::Kind::scalar || c.linear) return;
  for (size_t i = 0; i < n; ++i) {
    const Vec4f& q = c.of(batch.rgba[0][i]);
    for (int k = 0; k < 4; ++k) batch.rgba[k][i] = q[k];
  }
}

}  // namespace sg::raster
#endif
