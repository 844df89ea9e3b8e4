// SPDX-License-Identifier: Apache-2.0
// Cells chosen by a byte at each of their points. Inside filter/scalar only.
#pragma once
#include <cstdint>
#include <type_traits>

#include "data/mesh.h"

namespace sg::contouring {

/// Appends the cells of [begin, end) for which pick(or, and) of their points' bytes holds to `out` (room for end - begin + 1) and returns
/// how many. Without branches: the list of points is read at the speed of memory.
template <class Pick>
size_t scan_cells(const CellsView& cells, size_t begin, size_t end, const uint8_t* at, uint32_t* out, Pick&& pick) {
  size_t n = 0;
  auto all_of = [&]<class T, size_t size>(const T* ids, std::integral_constant<size_t, size>) {
    ids += begin * size;
    for (size_t c = begin; c < end; ++c, ids += size) {
      uint32_t any = at[ids[0]], every = any;
      for (size_t k = 1; k < size; ++k) any |= at[ids[k]], every &= at[ids[k]];
      out[n] = uint32_t(c);
      n += pick(any, every);
    }
  };
  auto sized = [&]<class T>(const T* ids) {
    if (cells.fixed == 4) return all_of(ids, std::integral_constant<size_t, 4>());
    if (cells.fixed == 8) return all_of(ids, std::integral_constant<size_t, 8>());
    for (size_t c = begin; c < end; ++c) {
      const size_t b = cells.begin(c), e = cells.end(c);
      uint32_t any = 0, every = b < e ? 255 : 0;
      for (size_t k = b; k < e; ++k) any |= at[ids[k]], every &= at[ids[k]];
      out[n] = uint32_t(c);
      n += pick(any, every);
    }
  };
  if (cells.connectivity.wide) sized(static_cast<const int64_t*>(cells.connectivity.data));
  else sized(static_cast<const int32_t*>(cells.connectivity.data));
  return n;
}

}  // namespace sg::contouring
