// SPDX-License-Identifier: Apache-2.0
#include "index/span/interval_tree.h"

#include <algorithm>
#include <tuple>

namespace sg {

IntervalTree::IntervalTree(const Spans& spans) {
  std::vector<uint32_t> items;
  items.reserve(spans.size());
  for (size_t i = 0; i < spans.size(); ++i)
    if (spans.lo[i] < spans.hi[i]) items.push_back(uint32_t(i));  // a constant item is crossed by no value
  by_lo_.reserve(items.size()), by_hi_.reserve(items.size());
  root_ = build(spans, items);
}

int32_t IntervalTree::build(const Spans& spans, std::vector<uint32_t>& items) {
  if (items.empty()) return -1;
  // The median of the lower ends: its own item crosses it, so every node holds one at least and no more than half go to either side.
  const auto middle = items.begin() + ptrdiff_t(items.size() / 2);
  std::nth_element(items.begin(), middle, items.end(), [&](uint32_t a, uint32_t b) { return spans.lo[a] < spans.lo[b]; });
  const float split = spans.lo[*middle];
  std::vector<uint32_t> below, above, here;
  for (uint32_t i : items) (spans.hi[i] < split ? below : spans.lo[i] > split ? above : here).push_back(i);
  items = {};

  const size_t me = nodes_.size();
  nodes_.push_back({split, uint32_t(by_lo_.size()), uint32_t(by_lo_.size() + here.size())});
  std::sort(here.begin(), here.end(), [&](uint32_t a, uint32_t b) { return std::tie(spans.lo[a], a) < std::tie(spans.lo[b], b); });
  for (uint32_t i : here) by_lo_.push_back({spans.lo[i], i});
  std::sort(here.begin(), here.end(), [&](uint32_t a, uint32_t b) { return std::tie(spans.hi[b], a) < std::tie(spans.hi[a], b); });
  for (uint32_t i : here) by_hi_.push_back({spans.hi[i], i});
  here = {};
  const int32_t b = build(spans, below), a = build(spans, above);
  nodes_[me].below = b, nodes_[me].above = a;
  return int32_t(me);
}

}  // namespace sg
