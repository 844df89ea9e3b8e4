// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/clip/cut_numbers.h"

#include <algorithm>
#include <bit>

#include "base/error.h"
#include "base/parallel.h"

namespace sg {

namespace {

struct Entry {
  uint64_t name;
  uint32_t place;  // in the concatenated lists
};

// Small enough for the second cache: an open hash of a bucket's distinct names.
struct Seen {
  std::vector<uint64_t> slots;
  std::vector<uint32_t> value;
  size_t mask = 0;
  static constexpr uint64_t none = ~uint64_t(0);
  void reset(size_t entries) {
    const size_t size = std::bit_ceil(std::max<size_t>(16, 2 * entries));
    slots.assign(size, none);
    value.resize(size);
    mask = size - 1;
  }
  size_t slot(uint64_t name) const {
    size_t s = size_t(name * 0x9E3779B97F4A7C15u >> 32) & mask;
    while (slots[s] != none && slots[s] != name) s = (s + 1) & mask;
    return s;
  }
};

}  // namespace

CutNumbers number_names(const std::vector<std::span<const uint64_t>>& chunks, size_t points) {
  CutNumbers r;
  std::vector<size_t> start(chunks.size() + 1);
  for (size_t c = 0; c < chunks.size(); ++c) start[c] = chunks[c].size();
  const size_t total = exclusive_scan(start);
  if (total > size_t(UINT32_MAX)) fail_usage("more than 2^32 cut edges", {}, "take a part of the mesh first");
  r.number.resize(total);
  if (total == 0) return r;
  // Buckets by the first end: names of neighbours lie together. Groups of chunks count for themselves.
  const size_t buckets = std::clamp<size_t>(total / 4096, 1, 4096), groups = std::min<size_t>(chunks.size(), 16);
  const double scale = double(buckets) / double(std::max<size_t>(points, 1));
  auto bucket_of = [&](uint64_t name) { return std::min(buckets - 1, size_t(double(name >> 32) * scale)); };
  auto group_range = [&](size_t g) { return std::pair(chunks.size() * g / groups, chunks.size() * (g + 1) / groups); };
  std::vector<size_t> at(buckets * groups + 1, 0);
  parallel_for(groups, 1, [&](size_t g, size_t) {
    const auto [first, last] = group_range(g);
    std::vector<size_t> count(buckets, 0);
    for (size_t c = first; c < last; ++c)
      for (const uint64_t name : chunks[c]) ++count[bucket_of(name)];
    for (size_t b = 0; b < buckets; ++b) at[b * groups + g] = count[b];
  });
  exclusive_scan(at);
  Plane<Entry> entries(total);
  parallel_for(groups, 1, [&](size_t g, size_t) {
    const auto [first, last] = group_range(g);
    std::vector<size_t> next(buckets);
    for (size_t b = 0; b < buckets; ++b) next[b] = at[b * groups + g];
    for (size_t c = first; c < last; ++c) {
      auto place = uint32_t(start[c]);
      for (const uint64_t name : chunks[c]) entries[next[bucket_of(name)]++] = {name, place++};
    }
  });
  // Distinct names of each bucket, then their places.
  std::vector<std::vector<uint64_t>> distinct(buckets);
  auto range = [&](size_t b) { return std::pair(at[b * groups], b + 1 < buckets ? at[(b + 1) * groups] : total); };
  parallel_for(buckets, 8, [&](size_t begin, size_t end) {
    Seen seen;
    for (size_t b = begin; b < end; ++b) {
      const auto [first, last] = range(b);
      seen.reset(last - first);
      auto& names = distinct[b];
      for (size_t i = first; i < last; ++i) {
        const size_t s = seen.slot(entries[i].name);
        if (seen.slots[s] == Seen::none) seen.slots[s] = entries[i].name, names.push_back(entries[i].name);
      }
      std::sort(names.begin(), names.end());
      for (size_t i = 0; i < names.size(); ++i) seen.value[seen.slot(names[i])] = uint32_t(i);
      for (size_t i = first; i < last; ++i) r.number[entries[i].place] = seen.value[seen.slot(entries[i].name)];
    }
  });
  std::vector<size_t> base(buckets + 1);
  for (size_t b = 0; b < buckets; ++b) base[b] = distinct[b].size();
  r.names.resize(exclusive_scan(base));
  parallel_for(buckets, 8, [&](size_t begin, size_t end) {
    for (size_t b = begin; b < end; ++b) {
      std::copy(distinct[b].begin(), distinct[b].end(), r.names.begin() + ptrdiff_t(base[b]));
      const auto [first, last] = range(b);
      for (size_t i = first; i < last; ++i) r.number[entries[i].place] += uint32_t(base[b]);
    }
  });
  return r;
}

}  // namespace sg
