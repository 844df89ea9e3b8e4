// SPDX-License-Identifier: Apache-2.0
// IntervalTree: items whose span a value crosses, in time proportional to their number (Edelsbrunner 1980; for isosurfaces: Cignoni,
// Marino, Montani, Puppo, Scopigno 1997).
#pragma once
#include "index/span/spans.h"

namespace sg {

/// Each node holds the items that cross its split value, twice: by rising lo and by falling hi, so that those that a query wants are the
/// first of one list. Build O(n log n), query O(log n + found), memory 16 bytes an item and 20 a node.
class IntervalTree {
 public:
  explicit IntervalTree(const Spans& spans);
  /// Calls f(item) for the active ones, in no useful order.
  template <class F>
  void active(double value, F&& f) const {
    for (int32_t at = root_; at >= 0;) {
      const Node& n = nodes_[size_t(at)];
      if (value <= double(n.split)) {  // each ends at or after the split: it is active when it begins before the value
        for (size_t i = n.first; i < n.last && double(by_lo_[i].key) < value; ++i) f(by_lo_[i].item);
        at = n.below;
      } else {  // each begins at or before the split
        for (size_t i = n.first; i < n.last && double(by_hi_[i].key) >= value; ++i) f(by_hi_[i].item);
        at = n.above;
      }
    }
  }
  size_t bytes() const { return nodes_.size() * sizeof(Node) + (by_lo_.size() + by_hi_.size()) * sizeof(Entry); }

 private:
  struct Entry {
    float key;
    uint32_t item;
  };
  struct Node {
    float split;
    uint32_t first, last;  ///< in both lists
    int32_t below = -1, above = -1;
  };
  int32_t build(const Spans& spans, std::vector<uint32_t>& items);

  std::vector<Node> nodes_;
  std::vector<Entry> by_lo_, by_hi_;
  int32_t root_ = -1;
};

}  // namespace sg
