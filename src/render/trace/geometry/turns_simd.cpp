// SPDX-License-Identifier: Apache-2.0
// Rays that go anywhere, a few in turns: what one of them looks at next comes from memory while the others are followed.
#include "base/vector_targets.h"
#include "render/trace/geometry/triangles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/trace/geometry/turns_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/trace/geometry/leaf-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::trace::HWY_NAMESPACE {

/// A ray on its way.
struct Turn {
  ShearedRay sheared;
  LeafRay leaf;
  NodeRay<false> nodes;
  Hit* hit;
  int number;
  bool found = false;
  Way way;

  Turn(const Ray& ray, Hit& hit, int number) : sheared(ray), leaf(sheared), nodes(BoxRay(ray)), hit(&hit), number(number) {}
};

constexpr int turns = 16;  // more leave the cache, fewer do not fill the time

uint64_t nearest_rays(const Triangles& in, const Ray* rays, int count, Hit* hits) {
  const WideNode* nodes = in.tree().nodes().data();
  const TriangleBlock* blocks = in.blocks().data();
  const Children children(nodes, blocks);
  alignas(64) std::byte room[turns][sizeof(Turn)];
  Turn* going[turns];
  for (int i = 0; i < turns; ++i) going[i] = reinterpret_cast<Turn*>(room[i]);
  int next = 0, busy = 0;
  uint64_t found = 0;
  const auto start = [&](int slot) {
    while (next < count && !can_trace(rays[next])) ++next;
    if (next >= count) return false;
    new (going[slot]) Turn(rays[next], hits[next], next);
    ++next;
    return true;
  };
  while (busy < turns && start(busy)) ++busy;
  while (busy > 0) {
    for (int slot = 0; slot < busy; ++slot) {
      Turn& r = *going[slot];
      if (!r.way.at_leaf()) {
        if (r.way.enter(nodes, r.nodes, r.hit->t, children)) continue;
      } else if (nearest_in(r.leaf, blocks[r.way.leaf()], *r.hit, r.found)) {
        in.fetch(r.hit->primitive);
      }
      if (r.way.next(r.hit->t)) continue;
      found |= uint64_t(r.found) << r.number;
      if (!start(slot)) std::swap(going[slot--], going[--busy]);
    }
  }
  return found;
}

}  // namespace sg::trace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::trace {

HWY_EXPORT(nearest_rays);

uint64_t Triangles::nearest_in_turns(const Ray* rays, int count, Hit* hits) const {
  return HWY_DYNAMIC_DISPATCH(nearest_rays)(*this, rays, count, hits);
}

}  // namespace sg::trace
#endif
