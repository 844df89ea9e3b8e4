// SPDX-License-Identifier: Apache-2.0
#include "index/span/active_index.h"

#include <algorithm>
#include <bit>

#include "base/error.h"

namespace sg {

namespace {

constexpr size_t group_size = 32;
constexpr double most_cells_per_crossed_one = 8;

std::variant<MinMaxOctree, IntervalTree, SpanTree, SpanLattice> make(const Spans& spans, ActiveIndexKind kind, const Context& context) {
  if (spans.size() > size_t(UINT32_MAX)) fail_usage("an index holds up to 2^32 items", "index", "index groups of cells");
  switch (kind) {
    case ActiveIndexKind::interval_tree: return IntervalTree(spans);
    case ActiveIndexKind::span_tree: return SpanTree(spans, context);
    case ActiveIndexKind::span_lattice: return SpanLattice(spans, context);
    case ActiveIndexKind::octree: break;
  }
  fail_internal("an octree needs a lattice, not a list of items");
}

// Ascending: few by comparing, many through a bit for each item.
void sort_items(std::vector<uint32_t>& found, size_t items) {
  if (found.size() < items / 1024) return std::sort(found.begin(), found.end());
  std::vector<uint64_t> bits((items + 63) / 64);
  for (uint32_t i : found) bits[i / 64] |= uint64_t(1) << (i % 64);
  size_t n = 0;
  for (size_t w = 0; w < bits.size(); ++w)
    for (uint64_t b = bits[w]; b; b &= b - 1) found[n++] = uint32_t(64 * w + size_t(std::countr_zero(b)));
}

// Of all spans that are not empty, so that twice the lengths is twice the items that a value of the range crosses on average.
double total_length(const Spans& s) {
  double sum = 0;
  for (size_t i = 0; i < s.size(); ++i)
    if (const double d = double(s.hi[i]) - double(s.lo[i]); d > 0 && std::isfinite(d)) sum += d;
  return sum;
}

}  // namespace

std::string_view active_index_name(ActiveIndexKind kind) {
  constexpr std::string_view names[] = {"min-max octree", "interval tree", "span-space k-d tree", "span-space lattice"};
  return names[size_t(kind)];
}

ActiveIndex::ActiveIndex(MinMaxOctree octree) : index_(std::move(octree)) {
  const auto& o = std::get<MinMaxOctree>(index_);
  items_ = o.levels.empty() ? 0 : o.levels[0].ranges.size();
}

ActiveIndex::ActiveIndex(const Spans& spans, ActiveIndexKind kind, const Context& context)
    : index_(make(spans, kind, context)), items_(spans.size()) {}

std::vector<uint32_t> ActiveIndex::active(double value) const {
  std::vector<uint32_t> found;
  if (const auto* octree = std::get_if<MinMaxOctree>(&index_)) {
    if (octree->levels.empty()) return found;
    const MinMaxOctree::Level& cubes = octree->levels[0];
    octree->containing(value, [&](size_t i, size_t j, size_t k) {
      const size_t id = cubes.id(i, j, k);
      if (Spans::active(cubes.ranges[id].lo, cubes.ranges[id].hi, value)) found.push_back(uint32_t(id));
    });
  } else {
    std::visit(
        [&](const auto& index) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(index)>, MinMaxOctree>)
            index.active(value, [&](uint32_t item) { found.push_back(item); });
        },
        index_);
  }
  sort_items(found, items_);
  return found;
}

size_t ActiveIndex::bytes() const {
  if (const auto* octree = std::get_if<MinMaxOctree>(&index_)) {
    size_t sum = 0;
    for (const auto& level : octree->levels) sum += level.ranges.size() * sizeof(MinMaxOctree::Range);
    return sum;
  }
  return std::visit(
      [](const auto& index) -> size_t {
        if constexpr (std::is_same_v<std::decay_t<decltype(index)>, MinMaxOctree>) return 0;
        else return index.bytes();
      },
      index_);
}

CellActiveIndex cell_active_index(const Dataset& mesh, const Array& samples, const Context& context) {
  double cells = 0;
  const Spans groups = cell_spans(mesh, samples, group_size, context, &cells);
  const bool near = total_length(groups) * double(group_size) <= most_cells_per_crossed_one * cells;
  return {ActiveIndex(near ? groups : cell_spans(mesh, samples, 1, context), ActiveIndexKind::span_lattice, context), near ? group_size : 1,
          mesh.cell_count()};
}

}  // namespace sg
