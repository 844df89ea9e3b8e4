// SPDX-License-Identifier: Apache-2.0
// Rays against trees of triangles: eight boxes, then eight triangles at once; of a packet sixteen rays against one triangle. No fused
// multiply-add: the same bytes for every width of vectors (triangle_test.h is the reference).
#include "render/trace/geometry/triangles.h"

#include <algorithm>
#include <cmath>

#include "base/vector_targets.h"
#include "render/trace/geometry/triangle_test.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/trace/geometry/triangles_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/trace/geometry/wide_bvh-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::trace::HWY_NAMESPACE {

/// Lanes of numbers for a test of triangle_test.h.
template <class D>
struct Crossing {
  Float<D> wa, wb, wc, za, zb, zc, det;
  Mask<D> met;  ///< by the line, not yet by where on it

  /// az: along kz from the origin; the others sheared.
  HWY_INLINE Crossing(Float<D> ax, Float<D> ay, Float<D> az, Float<D> bx, Float<D> by, Float<D> bz, Float<D> cx, Float<D> cy, Float<D> cz,
                      Float<D> sz) {
    wa = cx * by - cy * bx, wb = ax * cy - ay * cx, wc = bx * ay - by * ax;
    const auto over = (wa >= 0) & (wb >= 0) & (wc >= 0), under = (wa <= 0) & (wb <= 0) & (wc <= 0);
    met = over | under;
    if (none(met)) return;
    det = (wa + wb) + wc;
    za = az * sz, zb = bz * sz, zc = cz * sz;
    met = met & (det != 0) & !((za <= 0) & (zb <= 0) & (zc <= 0));
  }
  HWY_INLINE Mask<D> in_front() const { return (za > 0) & (zb > 0) & (zc > 0); }
  HWY_INLINE Float<D> distance() const { return ((wa * za + wb * zb) + wc * zc) / det; }
  HWY_INLINE Float<D> farthest() const { return max(max(za, zb), zc); }
};

/// A ray as the test reads it, its axes in order.
struct LeafRay {
  const ShearedRay& ray;
  float ox, oy, oz;
  size_t x, y, z;  ///< rows of a corner

  HWY_INLINE explicit LeafRay(const ShearedRay& r)
      : ray(r), ox(r.origin[r.kx]), oy(r.origin[r.ky]), oz(r.origin[r.kz]), x(size_t(r.kx) * wide), y(size_t(r.ky) * wide), z(size_t(r.kz) * wide) {}
};

HWY_INLINE Crossing<D8> cross_block(const LeafRay& r, const TriangleBlock& block, int i) {
  const D8 d;
  F8 x[3], y[3], z[3];
  for (int c = 0; c < 3; ++c) {
    const float* corner = &block.corner[c][0][0] + i;
    z[c] = hn::Load(d, corner + r.z) - r.oz;
    x[c] = (hn::Load(d, corner + r.x) - r.ox) - r.ray.sx * z[c];
    y[c] = (hn::Load(d, corner + r.y) - r.oy) - r.ray.sy * z[c];
  }
  return Crossing<D8>(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2], set(d, r.ray.sz));
}

Vec3f corner_of(const TriangleBlock& b, int c, int place) { return {b.corner[c][0][place], b.corner[c][1][place], b.corner[c][2][place]}; }

float exact(const ShearedRay& r, const TriangleBlock& b, int place, float farthest) {
  return exact_distance(r, corner_of(b, 0, place), corner_of(b, 1, place), corner_of(b, 2, place), farthest);
}

/// Takes what is nearer in the block; `found`: the hit is one already.
HWY_INLINE void nearest_in(const LeafRay& r, const TriangleBlock& block, Hit& hit, bool& found) {
  const D8 d;
  for (int i = 0; i < wide; i += lanes8) {
    const Crossing<D8> c = cross_block(r, block, i);
    if (none(c.met)) continue;
    const F8 t = c.distance();
    const auto front = c.in_front();
    uint32_t bits = bits_of(d, c.met & !(front & (t > hit.t)));
    if (bits == 0) continue;
    HWY_ALIGN float ts[lanes8], us[lanes8], vs[lanes8], far[lanes8];
    hn::Store(t, d, ts), hn::Store(c.wb / c.det, d, us), hn::Store(c.wc / c.det, d, vs), hn::Store(c.farthest(), d, far);
    const uint32_t in_front = bits_of(d, front);
    for (; bits; bits &= bits - 1) {
      const int lane = std::countr_zero(bits);
      const float at = in_front >> lane & 1 ? ts[lane] : exact(r.ray, block, i + lane, far[lane]);
      const uint32_t number = block.triangle[i + lane];
      if (!(at < hit.t || (at == hit.t && (!found || number < hit.primitive)))) continue;
      hit.t = at, hit.primitive = number, hit.u = us[lane], hit.v = vs[lane], found = true;
    }
  }
}

HWY_INLINE bool any_in(const LeafRay& r, const TriangleBlock& block, float t_max) {
  const D8 d;
  for (int i = 0; i < wide; i += lanes8) {
    const Crossing<D8> c = cross_block(r, block, i);
    if (none(c.met)) continue;
    const auto front = c.in_front();
    if (any(c.met & front & (c.distance() <= t_max))) return true;
    uint32_t bits = bits_of(d, c.met & !front);
    if (bits == 0) continue;
    HWY_ALIGN float far[lanes8];
    hn::Store(c.farthest(), d, far);
    for (; bits; bits &= bits - 1) {
      const int lane = std::countr_zero(bits);
      if (exact(r.ray, block, i + lane, far[lane]) <= t_max) return true;
    }
  }
  return false;
}

bool nearest_triangle(const Triangles& in, const Ray& ray, Hit& hit) {
  const ShearedRay sheared(ray);
  const LeafRay r(sheared);
  const TriangleBlock* blocks = in.blocks().data();
  bool found = false;
  walk<true>(
      in.tree().nodes().data(), NodeRay(BoxRay(ray)), hit.t,
      [&](uint32_t leaf) {
        nearest_in(r, blocks[leaf], hit, found);
        return false;
      },
      [&](uint32_t leaf) { prefetch_lines(blocks + leaf, 5); });
  return found;
}

bool any_triangle(const Triangles& in, const Ray& ray) {
  const ShearedRay sheared(ray);
  const LeafRay r(sheared);
  const TriangleBlock* blocks = in.blocks().data();
  bool found = false;
  walk<false>(
      in.tree().nodes().data(), NodeRay(BoxRay(ray)), ray.t_max, [&](uint32_t leaf) { return found = any_in(r, blocks[leaf], ray.t_max); },
      [&](uint32_t leaf) { prefetch_lines(blocks + leaf, 5); });
  return found;
}

// Packets: rays side by side, triangles one after the other.

using DP = hn::CappedTag<float, packet_rays>;
using FP = hn::Vec<DP>;
constexpr int lanes_p = int(hn::MaxLanes(DP()));

struct Packet {
  alignas(64) float ox[packet_rays], oy[packet_rays], oz[packet_rays];  // along kx, ky, kz
  alignas(64) float sx[packet_rays], sy[packet_rays], sz[packet_rays];
  alignas(64) float t[packet_rays], u[packet_rays], v[packet_rays];
  alignas(64) uint32_t primitive[packet_rays];
  uint32_t found = 0;
  float farthest = 0;  // largest of t
  int kx, ky, kz;
  const Ray* rays;
};

HWY_INLINE uint32_t bits_of_rays(Mask<DP> m) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(DP(), m, bytes);
  return uint32_t(bytes[0]) | uint32_t(bytes[1]) << 8;
}

HWY_INLINE void meet_packet(Packet& p, const TriangleBlock& block, int place) {
  const DP d;
  const hn::RebindToUnsigned<DP> du;
  const uint32_t number = block.triangle[place];
  bool nearer = false;
  for (int i = 0; i < packet_rays; i += lanes_p) {
    const FP ox = hn::Load(d, p.ox + i), oy = hn::Load(d, p.oy + i), oz = hn::Load(d, p.oz + i);
    const FP sx = hn::Load(d, p.sx + i), sy = hn::Load(d, p.sy + i);
    FP x[3], y[3], z[3];
    for (int c = 0; c < 3; ++c) {
      z[c] = block.corner[c][p.kz][place] - oz;
      x[c] = (block.corner[c][p.kx][place] - ox) - sx * z[c], y[c] = (block.corner[c][p.ky][place] - oy) - sy * z[c];
    }
    const Crossing<DP> c(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2], hn::Load(d, p.sz + i));
    if (none(c.met)) continue;
    FP t = c.distance();
    const auto front = c.in_front();
    if (any(c.met & !front)) {
      HWY_ALIGN float ts[lanes_p], far[lanes_p];
      hn::Store(t, d, ts), hn::Store(c.farthest(), d, far);
      for (uint32_t bits = bits_of_rays(c.met & !front) & ((1u << lanes_p) - 1); bits; bits &= bits - 1) {
        const int lane = std::countr_zero(bits);
        ts[lane] = exact(ShearedRay(p.rays[i + lane]), block, place, far[lane]);
      }
      t = hn::Load(d, ts);
    }
    const FP best = hn::Load(d, p.t + i);
    const auto before = hn::Load(du, p.primitive + i);
    const auto first = rebind(d, set(du, number) < before);
    const auto better = c.met & ((t < best) | ((t == best) & first));
    const uint32_t bits = bits_of_rays(better) & ((1u << lanes_p) - 1);
    if (bits == 0) continue;
    p.found |= bits << i, nearer = true;
    hn::Store(select(better, t, best), d, p.t + i);
    hn::Store(select(better, c.wb / c.det, hn::Load(d, p.u + i)), d, p.u + i);
    hn::Store(select(better, c.wc / c.det, hn::Load(d, p.v + i)), d, p.v + i);
    hn::Store(hn::IfThenElse(rebind(du, better), set(du, number), before), du, p.primitive + i);
  }
  if (!nearer) return;
  FP far = set(d, 0);
  for (int i = 0; i < packet_rays; i += lanes_p) far = max(far, hn::Load(d, p.t + i));
  p.farthest = hn::GetLane(hn::MaxOfLanes(d, far));
}

/// Sixteen rays with the same longest axis and signs; of fewer the last one stands in for the others.
uint32_t packet_triangles(const Triangles& in, const Ray* rays, int count, const ShearedRay& first, Hit* hits) {
  Packet p;
  p.kx = first.kx, p.ky = first.ky, p.kz = first.kz, p.rays = rays;
  NodeRay bounds{BoxRay(rays[0])};
  for (int i = 0; i < packet_rays; ++i) {
    const int k = std::min(i, count - 1);
    const ShearedRay r(rays[k]);
    p.ox[i] = r.origin[p.kx], p.oy[i] = r.origin[p.ky], p.oz[i] = r.origin[p.kz];
    p.sx[i] = r.sx, p.sy[i] = r.sy, p.sz[i] = r.sz;
    p.t[i] = i < count ? hits[k].t : -1, p.u[i] = 0, p.v[i] = 0, p.primitive[i] = UINT32_MAX;
    p.farthest = std::max(p.farthest, p.t[i]);
    if (i < count) bounds.widen(BoxRay(rays[k]));
  }
  const TriangleBlock* blocks = in.blocks().data();
  walk<true>(
      in.tree().nodes().data(), bounds, p.farthest,
      [&](uint32_t leaf) {
        const TriangleBlock& b = blocks[leaf];
        for (int k = 0; k < wide && b.triangle[k] != UINT32_MAX; ++k) meet_packet(p, b, k);
        return false;
      },
      [&](uint32_t leaf) { prefetch_lines(blocks + leaf, 5); });
  const uint32_t found = p.found & ((2u << (count - 1)) - 1);
  for (uint32_t bits = found; bits; bits &= bits - 1) {
    const int i = std::countr_zero(bits);
    hits[i].t = p.t[i], hits[i].primitive = p.primitive[i], hits[i].u = p.u[i], hits[i].v = p.v[i];
  }
  return found;
}

}  // namespace sg::trace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::trace {

HWY_EXPORT(nearest_triangle);
HWY_EXPORT(any_triangle);
HWY_EXPORT(packet_triangles);

namespace {

bool can_meet(const Triangles& in, const Ray& ray) { return !in.tree().empty() && can_trace(ray); }

}  // namespace

bool Triangles::nearest(const Ray& ray, Hit& hit) const {
  return can_meet(*this, ray) && HWY_DYNAMIC_DISPATCH(nearest_triangle)(*this, ray, hit);
}
uint32_t Triangles::nearest_packet(const Ray* rays, int count, Hit* hits) const {
  bool alike = true;
  const ShearedRay first(rays[0]);
  for (int i = 0; i < count && alike; ++i) {
    const Vec3f a = rays[0].direction, b = rays[i].direction;
    alike = can_meet(*this, rays[i]) && ShearedRay(rays[i]).kz == first.kz && (a.x < 0) == (b.x < 0) && (a.y < 0) == (b.y < 0) && (a.z < 0) == (b.z < 0);
  }
  if (alike && count > 1) return HWY_DYNAMIC_DISPATCH(packet_triangles)(*this, rays, count, first, hits);
  uint32_t found = 0;
  for (int i = 0; i < count; ++i) found |= uint32_t(nearest(rays[i], hits[i])) << i;
  return found;
}
bool Triangles::blocked(const Ray& ray) const { return can_meet(*this, ray) && HWY_DYNAMIC_DISPATCH(any_triangle)(*this, ray); }

}  // namespace sg::trace
#endif
