// SPDX-License-Identifier: Apache-2.0
// Particles sorted into the cells of a grid as wide as a kernel reaches: neighbours are found in the cells around.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"

namespace sg::liquid {

class Neighbours {
 public:
  /// Over a box, in cells of `width`. Flat: one cell along z.
  Neighbours(const Box3& box, double width, bool flat) : lo_(box.lo), width_(width) {
    for (int a = 0; a < 3; ++a) n_[size_t(a)] = flat && a == 2 ? 1 : std::max(1, int(std::ceil((box.hi[a] - box.lo[a]) / width)));
  }

  /// The order of places by cell, particles of a cell in the order in which they came; places outside of the box count to its border.
  const std::vector<uint32_t>& sort(std::span<const Vec3> x) {
    begin_.assign(size_t(n_[0]) * size_t(n_[1]) * size_t(n_[2]) + 1, 0);
    cell_.resize(x.size()), order_.resize(x.size());
    for (size_t i = 0; i < x.size(); ++i) ++begin_[(cell_[i] = cell_of(x[i])) + 1];
    for (size_t c = 0; c + 1 < begin_.size(); ++c) begin_[c + 1] += begin_[c];
    std::vector<uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (size_t i = 0; i < x.size(); ++i) order_[next[cell_[i]]++] = uint32_t(i);
    return order_;
  }

  /// Calls f(begin, end) for the stretches of the sorted particles that hold all within reach of x.
  template <class F>
  void around(Vec3 x, F&& f) const {
    int lo[3], hi[3];
    for (int a = 0; a < 3; ++a) {
      const int c = axis_cell(x, a);
      lo[a] = std::max(0, c - 1), hi[a] = std::min(n_[size_t(a)] - 1, c + 1);
    }
    for (int k = lo[2]; k <= hi[2]; ++k)
      for (int j = lo[1]; j <= hi[1]; ++j) {
        const size_t row = size_t(n_[0]) * (size_t(j) + size_t(n_[1]) * size_t(k));
        f(begin_[row + size_t(lo[0])], begin_[row + size_t(hi[0]) + 1]);
      }
  }

 private:
  int axis_cell(Vec3 x, int a) const { return int(std::clamp((x[a] - lo_[a]) / width_, 0.0, double(n_[size_t(a)] - 1))); }
  uint32_t cell_of(Vec3 x) const { return uint32_t(axis_cell(x, 0) + n_[0] * (axis_cell(x, 1) + n_[1] * axis_cell(x, 2))); }
  Vec3 lo_;
  double width_;
  std::array<int, 3> n_{};
  std::vector<uint32_t> begin_, cell_, order_;
};

}  // namespace sg::liquid
