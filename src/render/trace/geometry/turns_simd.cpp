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
  uint32_t at = 0;
  size_t top = 0;
  uint64_t stack[WideBvh::stack_size];

  Turn(const Ray& ray, Hit& hit, int number) : sheared(ray), leaf(sheared), nodes(BoxRay(ray)), hit(&hit), number(number) {}
};

constexpr int turns = 16;

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
  HWY_ALIGN float near[wide];
  while (busy > 0) {
    for (int slot = 0; slot < busy; ++slot) {
      Turn& r = *going[slot];
      bool pop = true;
      if (!(r.at & leaf_bit)) {
        const WideNode& n = nodes[r.at];
        uint32_t bits = r.nodes.meet(n, r.hit->t, near);
        if (bits) {
          const auto entry = [&] {
            const int i = std::countr_zero(bits);
            bits &= bits - 1;
            children.prefetch(n.child[i]);
            return uint64_t(std::bit_cast<uint32_t>(near[i])) << 32 | n.child[i];
          };
          uint64_t nearest = entry();
          for (const size_t base = r.top; bits; ++r.top) {
            const uint64_t e = entry(), farther = std::max(e, nearest);
            nearest = std::min(e, nearest);
            size_t k = r.top;
            for (; k > base && r.stack[k - 1] < farther; --k) r.stack[k] = r.stack[k - 1];
            r.stack[k] = farther;
          }
          r.at = uint32_t(nearest), pop = false;
        }
      } else if (nearest_in(r.leaf, blocks[r.at & ~leaf_bit], *r.hit, r.found)) {
        in.fetch(r.hit->primitive);
      }
      if (!pop) continue;
      while (r.top > 0 && std::bit_cast<float>(uint32_t(r.stack[r.top - 1] >> 32)) > r.hit->t) --r.top;
      if (r.top > 0) {
        r.at = uint32_t(r.stack[--r.top]);
        continue;
      }
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
