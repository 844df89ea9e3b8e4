// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/contour/cells/contour_edges.h"
#include "base/parallel.h"

namespace sg::contouring {

namespace {

// Open addressing with linear probing; keys are never 0, since the two ends of an edge differ.
class KeyTable {
 public:
  void reset(size_t expected) {
    count_ = 0;
    resize(std::bit_ceil(std::max<size_t>(16, 2 * expected)));
  }
  /// The number of the key; `next` when it is new.
  uint32_t insert(uint64_t key, uint32_t next) {
    for (size_t i = place(key);; i = (i + 1) & mask_) {
      Slot& s = slots_[i];
      if (s.key == key) return s.number;
      if (s.key != 0) continue;
      s = {key, next};
      if (++count_ > mask_ / 4 * 3) grow();
      return next;
    }
  }

 private:
  struct Slot {
    uint64_t key;
    uint32_t number;
  };
  size_t place(uint64_t key) const { return size_t(key * 0x9E3779B97F4A7C15ull >> shift_); }
  void resize(size_t size) {
    shift_ = 64 - std::countr_zero(size);
    mask_ = size - 1;
    if (slots_.size() < size) slots_.resize(size);
    std::fill_n(slots_.begin(), size, Slot{0, 0});
  }
  void grow() {
    const std::vector<Slot> old(slots_.begin(), slots_.begin() + ptrdiff_t(mask_) + 1);
    resize(2 * (mask_ + 1));
    for (const Slot& o : old) {
      if (o.key == 0) continue;
      size_t i = place(o.key);
      while (slots_[i].key != 0) i = (i + 1) & mask_;
      slots_[i] = o;
    }
  }
  std::vector<Slot> slots_;
  size_t mask_ = 0, count_ = 0;
  int shift_ = 0;
};

}  // namespace

void EdgeChunk::take(Found& found, size_t point_count) {
  thread_local KeyTable table;
  thread_local std::vector<uint64_t> unique;
  thread_local std::vector<uint32_t> place;
  table.reset(found.lines.size() + found.triangles.size() / 3);
  unique.clear();
  auto number = [&](const std::vector<uint64_t>& from, std::vector<uint32_t>& to) {
    to.resize(from.size());
    for (size_t i = 0; i < from.size(); ++i) {
      if (from[i] >> 63) {
        to[i] = inner_bit | uint32_t(from[i]);
        continue;
      }
      const uint32_t k = table.insert(from[i], uint32_t(unique.size()));
      if (k == unique.size()) unique.push_back(from[i]);
      to[i] = k;
    }
  };
  number(found.lines, lines);
  number(found.triangles, triangles);
  line_cells = found.line_cells, triangle_cells = found.triangle_cells;
  inner = found.inner;

  // Sort by part, stably.
  const uint64_t scale = ((uint64_t(parts) << 32) - 1) / std::max<uint64_t>(1, point_count);
  auto part = [&](uint64_t key) { return size_t((key >> 32) * scale >> 32); };
  std::array<uint32_t, parts + 1> at{};
  for (uint64_t k : unique) ++at[part(k) + 1];
  for (size_t p = 0; p < parts; ++p) at[p + 1] += at[p];
  begin = at;
  keys.resize(unique.size()), place.resize(unique.size());
  for (size_t i = 0; i < unique.size(); ++i) place[i] = at[part(unique[i])]++, keys[place[i]] = unique[i];
  for (auto* list : {&lines, &triangles})
    for (uint32_t& k : *list)
      if (!(k & inner_bit)) k = place[k];
}

EdgePoints::EdgePoints(std::vector<EdgeChunk>& chunks, const Context& context) {
  constexpr size_t few = 4096;
  size_t all = 0;
  for (EdgeChunk& c : chunks) c.numbers.resize(c.keys.size()), all += c.keys.size();
  if (all < few) grain_ = EdgeChunk::parts;
  first_.assign(EdgeChunk::parts + 1, 0);
  const auto number = [&](size_t part) {
    thread_local KeyTable table;
    size_t most = 0;
    for (const EdgeChunk& c : chunks) most += c.begin[part + 1] - c.begin[part];
    table.reset(most);
    auto& keys = keys_[part];
    keys.reserve(most);
    for (EdgeChunk& c : chunks)
      for (size_t i = c.begin[part]; i < c.begin[part + 1]; ++i) {
        const uint32_t k = table.insert(c.keys[i], uint32_t(keys.size()));
        if (k == keys.size()) keys.push_back(c.keys[i]);
        c.numbers[i] = k;
      }
    first_[part] = keys.size();
  };
  parallel_for(
      EdgeChunk::parts, grain_,
      [&](size_t begin, size_t end) {
        for (size_t part = begin; part < end; ++part) number(part);
      },
      &context);
  exclusive_scan(first_);
  parallel_for(
      chunks.size(), 1,
      [&](size_t i, size_t) {
        EdgeChunk& c = chunks[i];
        for (size_t part = 0; part < EdgeChunk::parts; ++part)
          for (size_t k = c.begin[part]; k < c.begin[part + 1]; ++k) c.numbers[k] += uint32_t(first_[part]);
        std::vector<uint64_t>().swap(c.keys);
      },
      &context);
}

}  // namespace sg::contouring
