// SPDX-License-Identifier: Apache-2.0
#include "index/span/span_tree.h"

#include <algorithm>
#include <functional>
#include <tuple>

#include "base/parallel.h"

namespace sg {

SpanTree::SpanTree(const Spans& spans, const Context& context) {
  points_.reserve(spans.size());
  for (size_t i = 0; i < spans.size(); ++i)
    if (spans.lo[i] < spans.hi[i]) points_.push_back({spans.lo[i], spans.hi[i], uint32_t(i)});
  struct Part {
    size_t begin, end;
  };
  // Level by level while the parts are few, then each part whole: borders depend on the number of points only.
  std::vector<Part> parts{{0, points_.size()}};
  const auto split = [&](Part part, bool by_lo) {
    const size_t middle = part.begin + (part.end - part.begin) / 2;
    const auto at = [&](size_t i) { return points_.begin() + ptrdiff_t(i); };
    // The item number breaks ties, so that the tree does not depend on how nth_element works.
    if (by_lo)
      std::nth_element(at(part.begin), at(middle), at(part.end),
                       [](const Point& a, const Point& b) { return std::tie(a.lo, a.item) < std::tie(b.lo, b.item); });
    else
      std::nth_element(at(part.begin), at(middle), at(part.end),
                       [](const Point& a, const Point& b) { return std::tie(a.hi, a.item) < std::tie(b.hi, b.item); });
    return middle;
  };
  bool by_lo = true;
  for (int level = 0; level < 5; ++level, by_lo = !by_lo) {
    std::vector<Part> next(2 * parts.size());
    parallel_for(
        parts.size(), 1,
        [&](size_t begin, size_t end) {
          for (size_t i = begin; i < end; ++i) {
            if (parts[i].begin == parts[i].end) {
              next[2 * i] = next[2 * i + 1] = parts[i];
              continue;
            }
            const size_t middle = split(parts[i], by_lo);
            next[2 * i] = {parts[i].begin, middle}, next[2 * i + 1] = {middle + 1, parts[i].end};
          }
        },
        &context);
    parts = std::move(next);
  }
  const std::function<void(Part, bool)> whole = [&](Part part, bool lo) {
    if (part.end - part.begin < 2) return;
    const size_t middle = split(part, lo);
    whole({part.begin, middle}, !lo), whole({middle + 1, part.end}, !lo);
  };
  parallel_for(
      parts.size(), 1,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) whole(parts[i], by_lo);
      },
      &context);
}

}  // namespace sg
