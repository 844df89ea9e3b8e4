// SPDX-License-Identifier: Apache-2.0
// CellTree: a bounding-volume hierarchy over the cells of any mesh. Binned surface-area heuristic (Wald 2007), built in parallel,
// the same tree for any number of threads. Boxes are f32, rounded outward, relative to the mesh's centre (double).
#pragma once
#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/context.h"
#include "base/huge_allocator.h"
#include "data/dataset.h"
#include "index/box_tree.h"

namespace sg {

class CellTree {
 public:
  /// No path from the root is longer: what a traversal needs as its stack.
  static constexpr int max_depth = BoxTree::max_depth;

  /// Over all cells that are not hidden, refined or duplicate and have a finite box. Each box is grown by 1e-7 of its size, so that a
  /// cell is found from a place that is outside by less than a locator's tolerance. O(n log n); under 60 bytes per cell at its peak,
  /// besides the mesh. Throws Error(usage) from 2^31 cells on.
  CellTree(DatasetPtr dataset, Context& context);
  /// Over boxes given by the caller; empty ones are left out.
  CellTree(std::span<const Box3> boxes, Context& context);

  /// Empty when no cell is in the tree; else the root is 0 (and 1 is unused).
  std::span<const TreeNode> nodes() const { return tree_.nodes; }
  std::span<const uint32_t> order() const { return tree_.order; }
  Vec3 center() const { return center_; }
  size_t bytes() const { return tree_.nodes.size() * sizeof(TreeNode) + tree_.order.size() * 4; }

  /// Calls f(cell) at least for each cell whose box holds x (grown by `slack`), in any order; f returns true to stop.
  template <class F>
  bool cells_at(Vec3 x, double slack, F&& f) const;
  /// Calls f(cell), near boxes first, at least for each cell whose box lies within the limit of x (squared distance <= limit2); f returns
  /// the new limit.
  template <class F>
  void nearest(Vec3 x, double limit2, F&& f) const;
  /// Calls f(cell) at least for each box that the ray x + t d, t in [t0, t1], meets, near ones first; f returns the new t1.
  template <class F>
  void along_ray(Vec3 x, Vec3 d, double t0, double t1, F&& f) const;
  /// Calls f(cell) at least for each cell whose box meets `box`.
  template <class F>
  void overlapping(const Box3& box, F&& f) const;

 private:
  template <class Meets, class F>
  bool descend(Meets&& meets, F&& f) const;
  BoxTree tree_;
  Vec3 center_{0, 0, 0};
};

namespace detail {

/// A float below (above) v; beyond 1e38 all numbers are one.
inline float float_below(double v) {
  const float f = float(std::min(std::max(v, -1e38), 1e38));
  return f - (std::abs(f) * 1.2e-7f + 1e-37f);
}
inline float float_above(double v) { return -float_below(-v); }

/// A box around [lo, hi] in the tree's numbers.
struct FloatBox {
  float lo[3], hi[3];
  FloatBox(Vec3 a, Vec3 b) {
    for (int i = 0; i < 3; ++i) lo[i] = float_below(a[i]), hi[i] = float_above(b[i]);
  }
  bool meets(const TreeNode& n) const {
    return (n.lo[0] <= hi[0]) & (n.hi[0] >= lo[0]) & (n.lo[1] <= hi[1]) & (n.hi[1] >= lo[1]) & (n.lo[2] <= hi[2]) & (n.hi[2] >= lo[2]);
  }
};

/// Squared distance of x (relative to the centre) to a node's box, rounded down.
inline double box_distance2(const TreeNode& n, Vec3 x) {
  double sum = 0;
  for (int a = 0; a < 3; ++a) {
    const double below = double(n.lo[a]) - x[a], above = x[a] - double(n.hi[a]);
    const double d = 0.5 * ((below + std::abs(below)) + (above + std::abs(above)));  // the positive one: a branch would be guessed
    sum += d * d;
  }
  return sum * (1 - 1e-14);
}

/// A ray against boxes: where it enters, +inf when it passes. Never misses for reasons of rounding.
struct BoxRay {
  Vec3 x, inverse;
  bool flat[3];
  BoxRay(Vec3 from, Vec3 d) : x(from) {
    for (int a = 0; a < 3; ++a) {
      inverse[a] = 1 / d[a];
      flat[a] = !std::isfinite(inverse[a]);
    }
  }
  double enter(const TreeNode& n, double t0, double t1) const {
    for (int a = 0; a < 3; ++a) {
      const double lo = double(n.lo[a]) - x[a], hi = double(n.hi[a]) - x[a];
      if (flat[a]) {
        if (lo > 0 || hi < 0) return HUGE_VAL;
        continue;
      }
      double near = lo * inverse[a], far = hi * inverse[a];
      if (near > far) std::swap(near, far);
      near -= std::abs(near) * 1e-14, far += std::abs(far) * 1e-14;
      t0 = near > t0 ? near : t0;
      t1 = far < t1 ? far : t1;
    }
    return t0 <= t1 ? t0 : HUGE_VAL;
  }
};

}  // namespace detail

template <class Meets, class F>
bool CellTree::descend(Meets&& meets, F&& f) const {
  if (tree_.nodes.empty() || !meets(tree_.nodes[0])) return false;
  uint32_t stack[max_depth];
  int top = 0;
  const TreeNode* n = &tree_.nodes[0];
  for (;;) {
    if (n->count) {
      for (uint32_t i = n->first; i < n->first + n->count; ++i)
        if (f(tree_.order[i])) return true;
    } else {
      const uint32_t child = n->first;
      const bool a = meets(tree_.nodes[child]), b = meets(tree_.nodes[child + 1]);
      if (a && b) stack[top++] = child + 1;
      if (a || b) {
        n = &tree_.nodes[a ? child : child + 1];
        continue;
      }
    }
    if (top == 0) return false;
    n = &tree_.nodes[stack[--top]];
  }
}

template <class F>
bool CellTree::cells_at(Vec3 x, double slack, F&& f) const {
  const Vec3 y = x - center_, s(slack, slack, slack);
  const detail::FloatBox box(y - s, y + s);
  return descend([&](const TreeNode& n) { return box.meets(n); }, f);
}

template <class F>
void CellTree::overlapping(const Box3& box, F&& f) const {
  const detail::FloatBox b(box.lo - center_, box.hi - center_);
  descend([&](const TreeNode& n) { return b.meets(n); }, [&](uint32_t cell) { return f(cell), false; });
}

template <class F>
void CellTree::nearest(Vec3 x, double limit2, F&& f) const {
  if (tree_.nodes.empty()) return;
  struct Entry {
    double distance2;
    uint32_t node;
  } stack[max_depth];
  const Vec3 y = x - center_;
  int top = 0;
  stack[top++] = {detail::box_distance2(tree_.nodes[0], y), 0};
  while (top > 0) {
    const Entry e = stack[--top];
    if (!(e.distance2 <= limit2)) continue;
    const TreeNode& n = tree_.nodes[e.node];
    if (n.count) {
      for (uint32_t i = n.first; i < n.first + n.count; ++i) limit2 = f(tree_.order[i]);
      continue;
    }
    const double a = detail::box_distance2(tree_.nodes[n.first], y), b = detail::box_distance2(tree_.nodes[n.first + 1], y);
    const bool first = a <= b;
    if (std::max(a, b) <= limit2) stack[top++] = first ? Entry{b, n.first + 1} : Entry{a, n.first};
    if (std::min(a, b) <= limit2) stack[top++] = first ? Entry{a, n.first} : Entry{b, n.first + 1};
  }
}

template <class F>
void CellTree::along_ray(Vec3 x, Vec3 d, double t0, double t1, F&& f) const {
  if (tree_.nodes.empty()) return;
  struct Entry {
    double t;
    uint32_t node;
  } stack[max_depth];
  const detail::BoxRay ray(x - center_, d);
  int top = 0;
  stack[top++] = {ray.enter(tree_.nodes[0], t0, t1), 0};
  while (top > 0) {
    const Entry e = stack[--top];
    if (!(e.t <= t1) || e.t == HUGE_VAL) continue;
    const TreeNode& n = tree_.nodes[e.node];
    if (n.count) {
      for (uint32_t i = n.first; i < n.first + n.count; ++i) t1 = f(tree_.order[i]);
      continue;
    }
    const double a = ray.enter(tree_.nodes[n.first], t0, t1), b = ray.enter(tree_.nodes[n.first + 1], t0, t1);
    const bool first = a <= b;
    if (std::max(a, b) < HUGE_VAL) stack[top++] = first ? Entry{b, n.first + 1} : Entry{a, n.first};
    if (std::min(a, b) < HUGE_VAL) stack[top++] = first ? Entry{a, n.first} : Entry{b, n.first + 1};
  }
}

}  // namespace sg
