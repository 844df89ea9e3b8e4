// SPDX-License-Identifier: Apache-2.0
// Rays through wide trees of anything: the boxes by vector code, what is in the leaves by the caller.
#pragma once
#include <type_traits>

#include "render/trace/geometry/wide_bvh.h"

namespace sg::trace {

namespace detail {
/// Looks at order()[first .. first+count); may lower the limit; true ends the walk.
using LeafFn = bool (*)(void* caller, uint32_t first, uint32_t count);
void walk_leaves(const WideBvh& tree, const Ray& ray, const float& t_max, bool ordered, LeafFn leaf, void* caller);
}  // namespace detail

/// Calls leaf(first, count) at least for each leaf of the tree that the ray meets before t_max, which is read again after each call; near
/// ones first where that is `ordered`.
template <class Leaf>
void walk_leaves(const WideBvh& tree, const Ray& ray, const float& t_max, bool ordered, Leaf&& leaf) {
  using Caller = std::remove_reference_t<Leaf>;
  detail::walk_leaves(
      tree, ray, t_max, ordered, [](void* p, uint32_t first, uint32_t count) { return (*static_cast<Caller*>(p))(first, count); },
      const_cast<std::remove_const_t<Caller>*>(&leaf));
}

}  // namespace sg::trace
