// SPDX-License-Identifier: Apache-2.0
#include "base/vector_targets.h"
#include "render/trace/tree/wide_bvh.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/trace/tree/wide_bvh_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/trace/tree/wide_bvh-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::trace::HWY_NAMESPACE {

void walk_tree(const WideBvh& tree, const Ray& ray, const float& t_max, bool ordered, detail::LeafFn leaf, void* caller) {
  const WideLeaf* leaves = tree.leaves().data();
  const auto look = [&](uint32_t i) { return leaf(caller, leaves[i].first, leaves[i].count); };
  const Children children(tree.nodes().data(), leaves);
  const NodeRay<false> r{BoxRay(ray)};
  if (ordered) walk(tree.nodes().data(), r, t_max, children, look);
  else walk_any(tree.nodes().data(), r, t_max, children, look);
}

}  // namespace sg::trace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::trace {

HWY_EXPORT(walk_tree);

void detail::walk_leaves(const WideBvh& tree, const Ray& ray, const float& t_max, bool ordered, LeafFn leaf, void* caller) {
  if (!tree.empty() && can_trace(ray)) HWY_DYNAMIC_DISPATCH(walk_tree)(tree, ray, t_max, ordered, leaf, caller);
}

}  // namespace sg::trace
#endif
