// SPDX-License-Identifier: Apache-2.0
#include "render/trace/tree/wide_bvh.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace sg::trace {

namespace {

// The node's eight: its two children, then the largest of them that can be opened is replaced by its own two, until there is no place left.
int open_up(std::span<const TreeNode> nodes, uint32_t of, uint32_t* out) {
  int n = 0;
  const TreeNode& top = nodes[of];
  if (top.count > 0) {
    out[n++] = of;
    return n;
  }
  out[n++] = top.first, out[n++] = top.first + 1;
  while (n < wide) {
    int largest = -1;
    double most = -1;
    for (int i = 0; i < n; ++i)
      if (nodes[out[i]].count == 0 && half_area(nodes[out[i]]) > most) most = half_area(nodes[out[i]]), largest = i;
    if (largest < 0) break;
    const uint32_t first = nodes[out[largest]].first;
    out[largest] = first, out[n++] = first + 1;
  }
  // Where any hit will do the last one is looked at first: the largest, which is the likeliest to hold one.
  std::stable_sort(out, out + n, [&](uint32_t a, uint32_t b) { return half_area(nodes[a]) < half_area(nodes[b]); });
  return n;
}

void set_box(WideNode& node, int place, const TreeNode& n) {
  for (int a = 0; a < 3; ++a) node.side[2 * a][place] = n.lo[a], node.side[2 * a + 1][place] = n.hi[a];
}

}  // namespace

WideBvh::WideBvh(BoxTree tree) : order_(std::move(tree.order)) {
  const std::span<const TreeNode> from = tree.nodes;
  if (from.empty()) return;
  bounds_ = {{from[0].lo[0], from[0].lo[1], from[0].lo[2]}, {from[0].hi[0], from[0].hi[1], from[0].hi[2]}};
  constexpr float far = std::numeric_limits<float>::infinity();
  struct Open {
    uint32_t from, to;
  };
  // Depth first: what a ray looks at next lies near.
  std::vector<Open> stack{{0, 0}};
  nodes_.reserve(from.size() / 8 + 1), leaves_.reserve(from.size() / 2 + 1);
  nodes_.resize(1);
  while (!stack.empty()) {
    const Open o = stack.back();
    stack.pop_back();
    uint32_t children[wide];
    const int n = open_up(from, o.from, children);
    const size_t first = nodes_.size();
    size_t inner = 0;
    for (int i = 0; i < n; ++i) inner += from[children[i]].count == 0;
    nodes_.resize(first + inner);
    WideNode& node = nodes_[o.to];
    node = WideNode{}, node.count = uint32_t(n);
    uint32_t next = uint32_t(first);
    for (int i = 0; i < wide; ++i) {
      if (i >= n) {
        for (int a = 0; a < 6; ++a) node.side[a][i] = a % 2 ? -far : far;
        node.child[i] = leaf_bit;
        continue;
      }
      const TreeNode& c = from[children[i]];
      set_box(node, i, c);
      if (c.count > 0) {
        node.child[i] = leaf_bit | uint32_t(leaves_.size());
        leaves_.push_back({c.first, c.count});
      } else {
        node.child[i] = next++;
      }
    }
    next = uint32_t(first + inner);
    for (int i = n - 1; i >= 0; --i)
      if (from[children[i]].count == 0) stack.push_back({children[i], --next});
  }
}

}  // namespace sg::trace
