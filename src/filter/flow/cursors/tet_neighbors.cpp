// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/cursors/tet_neighbors.h"

#include <algorithm>

#include "base/parallel.h"

namespace sg {

namespace {

// A face that waits for its other cell, in the list of its smallest point.
struct OpenFace {
  uint32_t b, c;         // the other points, ascending
  uint32_t cell_corner;  // four times the cell and the corner opposite, which fits 33 bits: hence `high`
  uint32_t high : 1, next : 31;
};
constexpr uint32_t no_face = 0x7fffffff;

class Matcher {
 public:
  Matcher(uint64_t lo, uint64_t hi, int32_t* out) : lo_(lo), hi_(hi), out_(out), head_(hi - lo, no_face) { pool_.reserve(1 << 14); }

  template <class T>
  void add_cells(const T* ids, size_t count) {
    for (size_t c = 0; c < count; ++c, ids += 4) {
      // Points with their corner in the low bits, sorted: the faces are the triples that leave one out.
      uint64_t k[4];
      for (int i = 0; i < 4; ++i) k[i] = uint64_t(ids[i]) << 2 | uint64_t(i);
      const auto order = [&](int i, int j) {
        const uint64_t a = std::min(k[i], k[j]), b = std::max(k[i], k[j]);
        k[i] = a, k[j] = b;
      };
      order(0, 1), order(2, 3), order(0, 2), order(1, 3), order(1, 2);
      const uint64_t s[4] = {k[0] >> 2, k[1] >> 2, k[2] >> 2, k[3] >> 2};
      if (s[0] >= lo_ && s[0] < hi_) {
        add(s[0], s[1], s[2], 4 * uint64_t(c) + (k[3] & 3));
        add(s[0], s[1], s[3], 4 * uint64_t(c) + (k[2] & 3));
        add(s[0], s[2], s[3], 4 * uint64_t(c) + (k[1] & 3));
      }
      if (s[1] >= lo_ && s[1] < hi_) add(s[1], s[2], s[3], 4 * uint64_t(c) + (k[0] & 3));
    }
  }

 private:
  void add(uint64_t a, uint64_t b, uint64_t c, uint64_t face) {
    if (a == b || b == c) return;  // collapsed
    uint32_t* link = &head_[a - lo_];
    uint32_t before = no_face;
    for (uint32_t at = *link; at != no_face; before = at, at = pool_[at].next) {
      const OpenFace& f = pool_[at];
      if (f.b != uint32_t(b) || f.c != uint32_t(c)) continue;
      const uint64_t other = uint64_t(f.high) << 32 | f.cell_corner;
      out_[face] = int32_t(other >> 2), out_[other] = int32_t(face >> 2);
      const uint32_t next = f.next;
      if (before == no_face) *link = next;
      else pool_[before].next = next;
      pool_[at].next = free_, free_ = at;
      return;
    }
    uint32_t at = free_;
    if (at != no_face) free_ = pool_[at].next;
    else at = uint32_t(pool_.size()), pool_.emplace_back();
    pool_[at] = {uint32_t(b), uint32_t(c), uint32_t(face), uint32_t(face >> 32) & 1u, *link & no_face};
    *link = at;
  }
  const uint64_t lo_, hi_;
  int32_t* out_;
  std::vector<uint32_t> head_;
  std::vector<OpenFace> pool_;
  uint32_t free_ = no_face;
};

}  // namespace

std::vector<int32_t, HugeAllocator<int32_t>> tet_neighbors(const CellsView& cells, size_t points, const Context& context) {
  std::vector<int32_t, HugeAllocator<int32_t>> out;
  out.resize(4 * cells.count);
  parallel_for(out.size(), 1 << 18,
               [&](size_t begin, size_t end) { std::fill(out.begin() + ptrdiff_t(begin), out.begin() + ptrdiff_t(end), -1); });
  // Each range of points reads all cells, in order, and matches the faces whose smallest point lies in it.
  const size_t ranges = points < 10000 ? 1 : size_t(std::clamp(thread_count(), 1, 16));
  const size_t first = cells.fixed == 4 || cells.count == 0 ? 0 : cells.begin(0);
  parallel_for(
      ranges, 1,
      [&](size_t r, size_t) {
        Matcher m(points * r / ranges, points * (r + 1) / ranges, out.data());
        if (cells.connectivity.wide) m.add_cells(static_cast<const int64_t*>(cells.connectivity.data) + first, cells.count);
        else m.add_cells(static_cast<const int32_t*>(cells.connectivity.data) + first, cells.count);
      },
      &context);
  return out;
}

}  // namespace sg
