// SPDX-License-Identifier: Apache-2.0
// WideBvh: a binary tree collapsed to nodes of eight boxes, which are tested at once; rays through it, whatever its leaves hold.
#pragma once
#include <cstdint>
#include <span>
#include <type_traits>

#include "base/huge_allocator.h"
#include "render/trace/tree/bvh.h"

namespace sg::trace {

constexpr int wide = 8;  ///< boxes of a node, and the most primitives of a leaf

/// 256 bytes. A child is a node's number, or a leaf's with `leaf_bit`; free places have boxes that no ray meets.
struct alignas(64) WideNode {
  float side[6][wide];  ///< lo x, hi x, lo y, hi y, lo z, hi z
  uint32_t child[wide];
  uint32_t count, unused[7];
};
constexpr uint32_t leaf_bit = 0x80000000u;

/// order()[first .. first+count)
struct WideLeaf {
  uint32_t first, count;
};

class WideBvh {
 public:
  /// No path from the root is longer, and each node on it leaves up to seven others for later.
  static constexpr int stack_size = 7 * BoxTree::max_depth + 8;

  WideBvh() = default;
  /// Leaves of the tree hold at most 8 primitives (TreeLimits::most).
  explicit WideBvh(BoxTree tree);

  bool empty() const { return nodes_.empty(); }
  std::span<const WideNode> nodes() const { return nodes_; }  ///< the root is 0
  std::span<const WideLeaf> leaves() const { return leaves_; }
  std::span<const uint32_t> order() const { return order_; }
  const Box3f& bounds() const { return bounds_; }
  size_t bytes() const { return nodes_.size() * sizeof(WideNode) + leaves_.size() * sizeof(WideLeaf) + order_.size() * 4; }

 private:
  Plane<WideNode> nodes_;
  Plane<WideLeaf> leaves_;
  Plane<uint32_t> order_;
  Box3f bounds_;
};

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
