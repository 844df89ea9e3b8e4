// SPDX-License-Identifier: Apache-2.0
// Bvh: a binary tree of boxes over primitives of any kind, and its traversal as one would write it on a board: the reference of the wide
// tree's. Surface-area heuristic, binned (index/box_tree.h).
#pragma once
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "index/box_tree.h"
#include "render/trace/tree/ray.h"

namespace sg::trace {

/// Half of its surface.
inline double half_area(const TreeNode& n) {
  const double x = double(n.hi[0]) - n.lo[0], y = double(n.hi[1]) - n.lo[1], z = double(n.hi[2]) - n.lo[2];
  return x * y + y * z + z * x;
}

/// Costs of a box and of a primitive, as the heuristic weighs them.
struct BvhCost {
  double box = 1, primitive = 1;
};

class Bvh {
 public:
  Bvh() = default;
  /// Over boxes that are finite and not empty (others are left out); primitives are numbered like them. Throws Error(usage) from 2^31 on.
  Bvh(std::span<const Box3f> boxes, const TreeLimits& limits, Context& context);
  explicit Bvh(BoxTree tree) : tree_(std::move(tree)) {}

  std::span<const TreeNode> nodes() const { return tree_.nodes; }
  BoxTree take() { return std::move(tree_); }
  std::span<const uint32_t> order() const { return tree_.order; }
  Box3f bounds() const;
  /// What a random ray that meets the root is expected to cost (MacDonald & Booth 1990): sum of (area / root's area) x cost.
  double expected_cost(const BvhCost& cost) const;
  size_t bytes() const { return tree_.nodes.size() * sizeof(TreeNode) + tree_.order.size() * 4; }

  /// Calls f(primitive), near boxes first, at least for each primitive whose box the ray meets before the limit that f returned last.
  template <class F>
  void along(const Ray& ray, F&& f) const;

 private:
  BoxTree tree_;
};

/// A ray against boxes, so that rounding never makes it miss one: near ends are rounded down, far ones up.
struct BoxRay {
  /// By so much the product below may be off, several times over: three roundings each here and where a triangle is moved before the ray
  /// (triangle_test.h), 2^-24 each.
  static constexpr float slack = 0x1p-20f;
  static constexpr float least = 1e-30f;  ///< a direction across an axis becomes this: 0 times infinity is no number

  float origin[3], near_inverse[3], far_inverse[3];
  bool backwards[3];

  explicit BoxRay(const Ray& r) {
    for (int a = 0; a < 3; ++a) {
      const float d = r.direction[a], away = std::max(std::abs(d), least);
      origin[a] = r.origin[a], backwards[a] = d < 0;
      const float inverse = std::copysign(1.f, backwards[a] ? d : 1.f) / away;
      near_inverse[a] = inverse * (1 - slack), far_inverse[a] = inverse * (1 + slack);
    }
  }
  /// Where the ray enters the box, infinity when it does not by t_max. A box without thickness has an inside.
  float enter(const float* lo, const float* hi, float t_max) const {
    float near = 0, far = t_max;
    for (int a = 0; a < 3; ++a) {
      const float first = ((backwards[a] ? hi : lo)[a] - origin[a]) * near_inverse[a];
      const float last = ((backwards[a] ? lo : hi)[a] - origin[a]) * far_inverse[a];
      near = first > near ? first : near;
      far = last < far ? last : far;
    }
    return near <= far ? near : std::numeric_limits<float>::infinity();
  }
};

template <class F>
void Bvh::along(const Ray& ray, F&& f) const {
  if (tree_.nodes.empty()) return;
  constexpr float none = std::numeric_limits<float>::infinity();
  struct Entry {
    float t;
    const TreeNode* node;
  } stack[BoxTree::max_depth + 2];
  const BoxRay r(ray);
  float t_max = ray.t_max;
  auto entry = [&](const TreeNode& n) { return Entry{r.enter(n.lo, n.hi, t_max), &n}; };
  int top = 0;
  stack[top++] = entry(tree_.nodes[0]);
  while (top > 0) {
    const Entry e = stack[--top];
    if (e.t > t_max || e.t == none) continue;
    const TreeNode& n = *e.node;
    if (n.count > 0) {
      for (uint32_t i = n.first; i < n.first + n.count; ++i) t_max = f(tree_.order[i]);
      continue;
    }
    Entry a = entry(tree_.nodes[n.first]), b = entry(tree_.nodes[n.first + 1]);
    if (a.t > b.t) std::swap(a, b);  // the nearer one is looked at next
    if (b.t != none) stack[top++] = b;
    if (a.t != none) stack[top++] = a;
  }
}

}  // namespace sg::trace
