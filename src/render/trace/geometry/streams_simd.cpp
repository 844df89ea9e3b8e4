// SPDX-License-Identifier: Apache-2.0
// Streams of rays against a tree of triangles: every node and leaf on the way of any of them is looked at once, by those that come there
// one after the other (Barringer, Akenine-Möller 2014, "Dynamic ray stream traversal"). The same result as for one ray.
#include <optional>

#include "base/vector_targets.h"
#include "render/trace/geometry/triangles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/trace/geometry/streams_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/trace/geometry/leaf-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::trace::HWY_NAMESPACE {

/// A ray as nodes and leaves ask for it.
struct StreamRay {
  ShearedRay sheared;
  LeafRay leaf;
  NodeRay<false> nodes;
  float t_max;

  explicit StreamRay(const Ray& ray) : sheared(ray), leaf(sheared), nodes(BoxRay(ray)), t_max(ray.t_max) {}
};

uint64_t blocked_rays(const Triangles& in, const Ray* rays, int count) {
  std::optional<StreamRay> stream[stream_rays];
  uint64_t going = 0, stopped = 0;
  for (int i = 0; i < count; ++i)
    if (can_trace(rays[i])) stream[i].emplace(rays[i]), going |= uint64_t(1) << i;
  const TriangleBlock* blocks = in.blocks().data();
  walk_together(
      in.tree().nodes().data(), going, Children(in.tree().nodes().data(), blocks),
      [&](const WideNode& n, int i) { return stream[i]->nodes.meet(n, stream[i]->t_max); },
      [&](uint32_t leaf, uint64_t here) {
        for (; here; here &= here - 1) {
          const int i = std::countr_zero(here);
          stopped |= uint64_t(any_in(stream[i]->leaf, blocks[leaf], stream[i]->t_max)) << i;
        }
        return stopped;
      });
  return stopped;
}

}  // namespace sg::trace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::trace {

HWY_EXPORT(blocked_rays);

uint64_t Triangles::blocked(const Ray* rays, int count) const {
  return tree_.empty() ? 0 : HWY_DYNAMIC_DISPATCH(blocked_rays)(*this, rays, count);
}

}  // namespace sg::trace
#endif
