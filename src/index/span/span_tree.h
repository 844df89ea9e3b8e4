// SPDX-License-Identifier: Apache-2.0
// SpanTree: a k-d tree in span space, where each item is the point (lo, hi) (NOISE: Livnat, Shen, Johnson 1996).
#pragma once
#include "index/span/spans.h"

namespace sg {

/// Without pointers: the middle of each range of points is its root, split by lo and by hi in turn. Build O(n log n), both cores;
/// query O(sqrt(n) + found); memory 12 bytes an item.
class SpanTree {
 public:
  SpanTree(const Spans& spans, const Context& context);
  /// Calls f(item) for the active ones, in no useful order.
  template <class F>
  void active(double value, F&& f) const {
    walk(0, points_.size(), true, value, f);
  }
  size_t bytes() const { return points_.size() * sizeof(Point); }

 private:
  struct Point {
    float lo, hi;
    uint32_t item;
  };
  template <class F>
  void walk(size_t begin, size_t end, bool by_lo, double value, F& f) const {
    while (begin < end) {
      const size_t middle = begin + (end - begin) / 2;
      const Point& p = points_[middle];
      if (Spans::active(p.lo, p.hi, value)) f(p.item);
      // Points before the middle have smaller coordinates, those behind it larger ones.
      if (by_lo) {
        if (double(p.lo) < value) walk(middle + 1, end, false, value, f);
        end = middle;
      } else {
        if (double(p.hi) >= value) walk(begin, middle, true, value, f);
        begin = middle + 1;
      }
      by_lo = !by_lo;
    }
  }
  std::vector<Point> points_;
};

}  // namespace sg
