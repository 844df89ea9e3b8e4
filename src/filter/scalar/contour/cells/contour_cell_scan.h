// SPDX-License-Identifier: Apache-2.0
// What loops over many cells need to be fast: cells chosen by a byte at each of their points, and positions without a call. Inside
// filter/scalar only.
#pragma once
#include <cstdint>
#include <type_traits>

#include "data/mesh.h"

namespace sg::contouring {

/// Points as doubles.
class Positions {
 public:
  explicit Positions(const Points& points) : xyz_(points.xyz.made_packed()), origin_(points.origin) {
    const bool single = xyz_.type() == ElementType::f32;
    floats_ = single ? reinterpret_cast<const float*>(xyz_.raw()) : nullptr;
    doubles_ = single ? nullptr : reinterpret_cast<const double*>(xyz_.raw());
  }
  Vec3 at(size_t p) const { return origin_ + offset(p); }
  /// From the origin of the points.
  Vec3 offset(size_t p) const {
    if (floats_) return {double(floats_[3 * p]), double(floats_[3 * p + 1]), double(floats_[3 * p + 2])};
    return {doubles_[3 * p], doubles_[3 * p + 1], doubles_[3 * p + 2]};
  }
  /// The numbers themselves: one of the two is there.
  const float* floats() const { return floats_; }
  const double* doubles() const { return doubles_; }

 private:
  Array xyz_;
  Vec3 origin_;
  const float* floats_;
  const double* doubles_;
};

/// Appends the cells of [begin, end) for which pick(or, and) of their points' bytes holds to `out` (room for end - begin + 1) and returns
/// how many. Without branches: the list of points is read at the speed of memory.
template <class Pick>
size_t scan_cells(const CellsView& cells, size_t begin, size_t end, const uint8_t* at, uint32_t* out, Pick&& pick) {
  size_t n = 0;
  auto all_of = [&]<class T, size_t size>(const T* ids, std::integral_constant<size_t, size>) {
    ids += begin * size;
    for (size_t c = begin; c < end; ++c, ids += size) {
      __builtin_prefetch(ids + 4096 / sizeof(T));  // over the border of the page, where the machine's own reading ahead stops
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
