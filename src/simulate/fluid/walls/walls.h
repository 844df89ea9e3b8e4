// SPDX-License-Identifier: Apache-2.0
// Where the flow cannot go.
#pragma once
#include "simulate/fluid/mac_grid.h"

namespace sg::fluid {

/// What lies beyond the six sides of the box, x0 x1 y0 y1 z0 z1: a wall, or free space in which the pressure is 0.
using OpenSides = std::array<bool, 6>;

/// The share of each face that is open: 0 where it is solid, and on the closed sides of the box.
template <class T>
struct Walls {
  OpenSides sides{};
  Faces<T> open;               ///< empty where nothing is solid but the closed sides
  Faces<T> solid;              ///< velocity of the solid part of each face, across it; empty where nothing moves
  std::array<T, 6> through{};  ///< velocity across the closed sides

  bool obstacles() const { return !open[0].values.empty(); }
  bool move() const { return !solid[0].values.empty(); }
  /// Of face (i, j, k) across `axis` of a box with so many cells.
  T share(const std::array<size_t, 3>& cells, int axis, size_t i, size_t j, size_t k) const {
    const size_t a = size_t(axis), at = a == 0 ? i : a == 1 ? j : k;
    if ((at == 0 && !sides[2 * a]) || (at == cells[a] && !sides[2 * a + 1])) return 0;
    return obstacles() ? open[a](i, j, k) : T(1);
  }
  /// Makes the faces on the closed sides solid, as they are meant.
  void close_sides() {
    if (!obstacles()) return;
    for (size_t a = 0; a < 3; ++a)
      for (size_t side = 0; side < 2; ++side) {
        if (sides[2 * a + side]) continue;
        std::array<size_t, 3> lo{0, 0, 0}, hi = open[a].n;
        lo[a] = side ? hi[a] - 1 : 0, hi[a] = lo[a] + 1;
        for (size_t k = lo[2]; k < hi[2]; ++k)
          for (size_t j = lo[1]; j < hi[1]; ++j)
            for (size_t i = lo[0]; i < hi[0]; ++i) open[a](i, j, k) = 0;
      }
  }
};

}  // namespace sg::fluid
