// SPDX-License-Identifier: Apache-2.0
// Rays against a tree of triangles: eight boxes, then eight triangles at once. No fused multiply-add: the same bytes for every width of
// vectors (triangle_test.h is the reference).
#include "render/trace/geometry/triangles.h"

#include <optional>

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/trace/geometry/triangles_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/trace/geometry/crossing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::trace::HWY_NAMESPACE {

/// A ray as the test reads it, its axes in order.
struct LeafRay {
  const ShearedRay& ray;
  float ox, oy, oz;
  size_t x, y, z;  ///< rows of a corner

  HWY_INLINE explicit LeafRay(const ShearedRay& r)
      : ray(r),
        ox(r.origin[r.kx]),
        oy(r.origin[r.ky]),
        oz(r.origin[r.kz]),
        x(size_t(r.kx) * wide),
        y(size_t(r.ky) * wide),
        z(size_t(r.kz) * wide) {}
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
  walk(
      in.tree().nodes().data(), NodeRay<false>(BoxRay(ray)), hit.t,
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
  walk_any(
      in.tree().nodes().data(), NodeRay<false>(BoxRay(ray)), ray.t_max,
      [&](uint32_t leaf) { return found = any_in(r, blocks[leaf], ray.t_max); }, [&](uint32_t leaf) { prefetch_lines(blocks + leaf, 5); });
  return found;
}

/// One of several rays on their way, each of which does a node or a leaf in its turn: what it needs next is fetched while the others are at
/// work.
struct Walker {
  Walker(const Ray& ray, int i) : sheared(ray), leaf(sheared), nodes(BoxRay(ray)), t_max(ray.t_max), number(i) {}
  ShearedRay sheared;
  LeafRay leaf;
  NodeRay<false> nodes;
  float t_max;
  int number;
  uint32_t at = 0;
  size_t top = 0;
  uint32_t stack[WideBvh::stack_size];
};

enum class Way { goes_on, stopped, free };

HWY_INLINE Way step(const Triangles& in, Walker& w) {
  const WideNode* nodes = in.tree().nodes().data();
  const TriangleBlock* blocks = in.blocks().data();
  if (w.at & leaf_bit) {
    if (any_in(w.leaf, blocks[w.at & ~leaf_bit], w.t_max)) return Way::stopped;
  } else {
    const WideNode& n = nodes[w.at];
    HWY_ALIGN float near[wide];
    for (uint32_t bits = w.nodes.meet(n, w.t_max, near); bits; bits &= bits - 1) w.stack[w.top++] = n.child[std::countr_zero(bits)];
  }
  if (w.top == 0) return Way::free;
  w.at = w.stack[--w.top];
  if (w.at & leaf_bit) prefetch_lines(blocks + (w.at & ~leaf_bit), 5);
  else prefetch_node(nodes + w.at);
  return Way::goes_on;
}

uint32_t blocked_rays(const Triangles& in, const Ray* rays, int count) {
  std::optional<Walker> all[several_rays];
  Walker* walkers[several_rays];
  int going = 0;
  for (int i = 0; i < count; ++i)
    if (can_trace(rays[i])) walkers[going++] = &all[i].emplace(rays[i], i);
  uint32_t stopped = 0;
  while (going > 0)
    for (int k = 0; k < going;) {
      const Way way = step(in, *walkers[k]);
      if (way == Way::goes_on) {
        ++k;
        continue;
      }
      if (way == Way::stopped) stopped |= 1u << walkers[k]->number;
      walkers[k] = walkers[--going];
    }
  return stopped;
}

}  // namespace sg::trace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::trace {

HWY_EXPORT(nearest_triangle);
HWY_EXPORT(any_triangle);
HWY_EXPORT(blocked_rays);

bool Triangles::nearest(const Ray& ray, Hit& hit) const {
  return can_trace(ray) && !tree_.empty() && HWY_DYNAMIC_DISPATCH(nearest_triangle)(*this, ray, hit);
}
bool Triangles::blocked(const Ray& ray) const { return can_trace(ray) && !tree_.empty() && HWY_DYNAMIC_DISPATCH(any_triangle)(*this, ray); }

uint32_t Triangles::blocked(const Ray* rays, int count) const {
  return tree_.empty() ? 0 : HWY_DYNAMIC_DISPATCH(blocked_rays)(*this, rays, count);
}

}  // namespace sg::trace
#endif
