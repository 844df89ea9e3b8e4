// SPDX-License-Identifier: Apache-2.0
// Combined state of a cell's corners: a byte per point joined over each cell.
#pragma once
#include <cstdint>

#include "data/mesh.h"

namespace sg {

namespace detail {
template <class Id, class Join>
void join_corners(const CellsView& v, const Id* ids, size_t begin, size_t end, const uint8_t* point, uint8_t* out, Join join) {
  if (v.fixed == 4) {
    for (size_t c = begin; c < end; ++c) {
      const Id* p = ids + 4 * c;
      out[c - begin] = join(join(point[p[0]], point[p[1]]), join(point[p[2]], point[p[3]]));
    }
    return;
  }
  for (size_t c = begin, first = v.begin(begin); c < end; ++c) {
    const size_t last = v.end(c);
    uint8_t r = first < last ? point[ids[first]] : uint8_t(0);
    for (size_t k = first + 1; k < last; ++k) r = join(r, point[ids[k]]);
    out[c - begin] = r;
    first = last;
  }
}
template <class Join>
void join_corners(const CellsView& v, size_t begin, size_t end, const uint8_t* point, uint8_t* out, Join join) {
  if (v.connectivity.wide) join_corners(v, static_cast<const int64_t*>(v.connectivity.data), begin, end, point, out, join);
  else join_corners(v, static_cast<const int32_t*>(v.connectivity.data), begin, end, point, out, join);
}
}  // namespace detail

/// Bytes of all points of each cell in [begin, end) joined by or; 0 for cells without points.
inline void any_of_corners(const CellsView& v, size_t begin, size_t end, const uint8_t* point, uint8_t* out) {
  detail::join_corners(v, begin, end, point, out, [](uint8_t a, uint8_t b) { return uint8_t(a | b); });
}
/// The same joined by and.
inline void all_of_corners(const CellsView& v, size_t begin, size_t end, const uint8_t* point, uint8_t* out) {
  detail::join_corners(v, begin, end, point, out, [](uint8_t a, uint8_t b) { return uint8_t(a & b); });
}

}  // namespace sg
