// SPDX-License-Identifier: Apache-2.0
// Sixteen rays at once against a tree of triangles: a node against all lines between the packet's extremes, then one triangle against the
// rays, side by side. The same bytes for every width of vectors, and as for one ray.
#include <algorithm>

#include "base/vector_targets.h"
#include "render/trace/geometry/triangles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/trace/geometry/packets_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/trace/geometry/crossing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::trace::HWY_NAMESPACE {

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

/// Whether the triangle is the nearest of some.
HWY_INLINE bool meet_packet(Packet& p, const TriangleBlock& block, int place) {
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
    hn::Store(select(better, set(du, number), before), du, p.primitive + i);
  }
  if (!nearer) return false;
  FP far = set(d, 0);
  for (int i = 0; i < packet_rays; i += lanes_p) far = max(far, hn::Load(d, p.t + i));
  p.farthest = hn::GetLane(hn::MaxOfLanes(d, far));
  return true;
}

/// Sixteen rays with the same longest axis and signs; of fewer the last one stands in for the others.
uint32_t packet_triangles(const Triangles& in, const Ray* rays, int count, const ShearedRay& first, Hit* hits) {
  Packet p;
  p.kx = first.kx, p.ky = first.ky, p.kz = first.kz, p.rays = rays;
  NodeRay<true> bounds{BoxRay(rays[0])};
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
  walk(in.tree().nodes().data(), bounds, p.farthest, Children(in.tree().nodes().data(), blocks), [&](uint32_t leaf) {
    const TriangleBlock& b = blocks[leaf];
    for (int k = 0; k < wide && b.triangle[k] != UINT32_MAX; ++k)
      if (meet_packet(p, b, k)) in.fetch(b.triangle[k]);
    return false;
  });
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

HWY_EXPORT(packet_triangles);

uint32_t Triangles::nearest_packet(const Ray* rays, int count, Hit* hits) const {
  return HWY_DYNAMIC_DISPATCH(packet_triangles)(*this, rays, count, ShearedRay(rays[0]), hits);
}

}  // namespace sg::trace
#endif
