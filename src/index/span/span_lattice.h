// SPDX-License-Identifier: Apache-2.0
// SpanLattice: span space cut into a lattice of buckets (ISSUE: Shen, Hansen, Livnat, Johnson 1996).
#pragma once
#include "index/span/spans.h"

namespace sg {

/// Columns cut the axis of the lower ends where they hold about equally many items, and the same borders cut the upper ends. For a
/// value in column c, buckets (i < c, j > c) are active as they are; only those with i = c or j = c are looked into. Items lie bucket by
/// bucket, upper ends falling, in one list: what a column gives is the beginning of its list. Build O(n log columns), query
/// O(columns + found + n / columns), memory 12 bytes an item.
class SpanLattice {
 public:
  SpanLattice(const Spans& spans, const Context& context);
  /// Calls f(item) for the active ones: column by column, upper ends falling, item numbers rising inside a bucket.
  template <class F>
  void active(double value, F&& f) const {
    if (columns_ == 0) return;
    const size_t c = column_of(value);
    for (size_t i = 0; i <= c; ++i) {
      const size_t* bucket = &start_[i * columns_];                      // of falling j: the last column first
      const size_t sure = i < c ? bucket[columns_ - 1 - c] : bucket[0];  // end of the buckets j > c
      for (size_t k = bucket[0]; k < sure; ++k) f(points_[k].item);
      for (size_t k = sure; k < bucket[columns_ - c]; ++k)
        if (Spans::active(points_[k].lo, points_[k].hi, value)) f(points_[k].item);
    }
  }
  size_t bytes() const { return points_.size() * sizeof(Point) + start_.size() * sizeof(size_t); }
  size_t columns() const { return columns_; }

 private:
  struct Point {
    float lo, hi;
    uint32_t item;
  };
  size_t column_of(double value) const;

  size_t columns_ = 0;
  std::vector<float> borders_;  ///< where column i+1 begins
  std::vector<size_t> start_;   ///< of bucket (column i, j-th from the top) at i * columns + j
  std::vector<Point> points_;
};

}  // namespace sg
