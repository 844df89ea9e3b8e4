// SPDX-License-Identifier: Apache-2.0
// A bounding-volume hierarchy over boxes. Binned surface-area heuristic (Wald 2007), built in parallel, the same tree for any number of
// threads. What CellTree and the path tracer's trees are made of.
#pragma once
#include <cstdint>

#include "base/context.h"
#include "base/huge_allocator.h"

namespace sg {

/// 32 bytes. Inner: count == 0, children at `first` and `first`+1 (`first` is even: both lie in one cache line). Leaf: count > 0, boxes
/// order[first .. first+count).
struct TreeNode {
  float lo[3], hi[3];
  uint32_t first;
  uint32_t count;
};

/// A box and its owner while the tree is built.
struct TreeRecord {
  float lo[3], hi[3];
  uint32_t cell;
};

/// When a node stays a leaf.
struct TreeLimits {
  uint32_t most = 8;     ///< a node of more boxes is always split
  uint32_t least = 2;    ///< one of so many or fewer never
  uint32_t at_once = 1;  ///< owners that one test looks at
  float of_node = 1.5;   ///< cost of a node in units of one box's owner's test
};

struct BoxTree {
  /// No path from the root is longer: what a traversal needs as its stack.
  static constexpr int max_depth = 88;

  Plane<TreeNode> nodes;  ///< empty when there are no boxes; else the root is 0 (and 1 is unused)
  Plane<uint32_t> order;  ///< the owners, leaf by leaf
};

/// O(n log n); under 60 bytes per box at its peak. The boxes must be finite and not empty (lo <= hi), fewer than 2^31.
BoxTree build_box_tree(Plane<TreeRecord> records, const TreeLimits& limits, Context& context);

}  // namespace sg
