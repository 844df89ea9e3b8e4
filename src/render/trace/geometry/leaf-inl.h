// SPDX-License-Identifier: Apache-2.0
// A ray and a leaf: the test of triangle_test.h for eight triangles at once. For files that are compiled once for each target and have
// included Highway.
#if defined(SG_TRACE_LEAF_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_TRACE_LEAF_INL
#undef SG_TRACE_LEAF_INL
#else
#define SG_TRACE_LEAF_INL
#endif
#include "render/trace/geometry/crossing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::trace::HWY_NAMESPACE {

/// A ray as the test reads it, its axes in order.
struct LeafRay {
  const ShearedRay& ray;
  float ox, oy, oz;
  size_t x, y, z;  ///< rows of a corner

  HWY_INLINE explicit LeafRay(const ShearedRay& r) : ray(r), x(size_t(r.kx) * wide), y(size_t(r.ky) * wide), z(size_t(r.kz) * wide) {
    const float origin[3] = {r.origin.x, r.origin.y, r.origin.z};
    ox = origin[r.kx], oy = origin[r.ky], oz = origin[r.kz];
  }
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

/// Takes what is nearer in the block, and whether there is any; `found`: the hit is one already.
HWY_INLINE bool nearest_in(const LeafRay& r, const TriangleBlock& block, Hit& hit, bool& found) {
  const D8 d;
  bool nearer = false;
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
      hit.t = at, hit.primitive = number, hit.u = us[lane], hit.v = vs[lane], found = nearer = true;
    }
  }
  return nearer;
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

}  // namespace sg::trace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
