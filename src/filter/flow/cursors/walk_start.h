// SPDX-License-Identifier: Apache-2.0
// Where to begin to walk through a mesh: a cell near each bin of its box. Internal to filter/flow.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/vec.h"

namespace sg {

struct WalkStart {
  Box3 box;
  std::array<size_t, 3> bins{1, 1, 1};
  std::vector<int32_t> start;  ///< -1 only where no cell may begin a walk

  WalkStart() = default;
  /// `corner(cell)` is a point of the cell; `takes(cell)` whether walks may begin there. O(cells / 4).
  template <class Corner, class Takes>
  WalkStart(const Box3& of, size_t cells, Corner&& corner, Takes&& takes) : box(of) {
    const size_t n = std::clamp<size_t>(size_t(std::cbrt(double(cells) / 16)), 1, 64);
    bins = {n, n, n};
    start.assign(n * n * n, -1);
    // Every few cells one by its first corner; bins that stay empty take the one before, the first ones the first after them.
    const size_t stride = cells > 4096 ? 4 : 1;
    int32_t last = -1;
    for (size_t c = 0; c < cells; c += stride) {
      if (!takes(c)) continue;
      start[bin(corner(c))] = int32_t(c);
      if (last < 0) last = int32_t(c);
    }
    for (int32_t& c : start) {
      if (c < 0) c = last;
      last = c;
    }
  }
  int32_t near(Vec3 x) const { return start.empty() ? -1 : start[bin(x)]; }
  /// Not outside of the box, but for rounding.
  bool may_hold(Vec3 x) const {
    for (int a = 0; a < 3; ++a) {
      const double slack = 1e-9 * (box.hi[a] - box.lo[a]);
      if (!(x[a] >= box.lo[a] - slack && x[a] <= box.hi[a] + slack)) return false;
    }
    return true;
  }
  size_t bytes() const { return start.size() * 4; }

 private:
  size_t bin(Vec3 x) const {
    size_t at[3];
    for (int a = 0; a < 3; ++a) {
      const double s = box.hi[a] - box.lo[a], f = s > 0 ? (x[a] - box.lo[a]) / s * double(bins[size_t(a)]) : 0;
      at[a] = size_t(std::min(std::max(0.0, f), double(bins[size_t(a)] - 1)));  // NaN: 0
    }
    return at[0] + bins[0] * (at[1] + bins[1] * at[2]);
  }
};

}  // namespace sg
