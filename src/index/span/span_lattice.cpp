// SPDX-License-Identifier: Apache-2.0
#include "index/span/span_lattice.h"

#include <algorithm>

#include "base/parallel.h"

namespace sg {

namespace {
// As many columns as keep the list of buckets small relative to the items, and the row and column to be searched short.
size_t columns_for(size_t items) { return std::clamp<size_t>(size_t(std::cbrt(double(items)) * 2), 1, 512); }
}  // namespace

// The column that a number lies in: column i holds borders[i-1] <= v < borders[i].
size_t SpanLattice::column_of(double value) const {
  return size_t(std::upper_bound(borders_.begin(), borders_.end(), value, [](double v, float b) { return v < double(b); }) -
                borders_.begin());
}

SpanLattice::SpanLattice(const Spans& spans, const Context& context) {
  std::vector<uint32_t> items;
  items.reserve(spans.size());
  for (size_t i = 0; i < spans.size(); ++i)
    if (spans.lo[i] < spans.hi[i]) items.push_back(uint32_t(i));
  if (items.empty()) return;
  columns_ = columns_for(items.size());

  // Borders from a sample of both ends.
  std::vector<float> ends;
  const size_t step = std::max<size_t>(1, items.size() / (64 * columns_));
  for (size_t k = 0; k < items.size(); k += step) ends.push_back(spans.lo[items[k]]), ends.push_back(spans.hi[items[k]]);
  std::sort(ends.begin(), ends.end());
  for (size_t i = 1; i < columns_; ++i) borders_.push_back(ends[i * ends.size() / columns_]);

  // Counting sort by bucket; stable, so that item numbers rise.
  std::vector<uint32_t> bucket(items.size());
  start_.assign(columns_ * columns_ + 1, 0);
  parallel_for(
      items.size(), 1 << 15,
      [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
          const size_t i = column_of(double(spans.lo[items[k]])), j = column_of(double(spans.hi[items[k]]));
          bucket[k] = uint32_t(i * columns_ + (columns_ - 1 - j));
        }
      },
      &context);
  for (uint32_t b : bucket) ++start_[b + 1];
  for (size_t b = 1; b < start_.size(); ++b) start_[b] += start_[b - 1];
  std::vector<size_t> next(start_.begin(), start_.end() - 1);
  points_.resize(items.size());
  for (size_t k = 0; k < items.size(); ++k) points_[next[bucket[k]]++] = {spans.lo[items[k]], spans.hi[items[k]], items[k]};
}

}  // namespace sg
