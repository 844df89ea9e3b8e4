// SPDX-License-Identifier: Apache-2.0
// Boxes that lie still, in the cells of a grid: which of them may meet another box.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/vec.h"

namespace sg::swarm {

class BoxGrid {
 public:
  BoxGrid() = default;
  explicit BoxGrid(std::vector<Box3> boxes);
  bool empty() const { return boxes_.empty(); }
  /// Those that overlap `box` or touch it, in ascending order, in `out`.
  void find(const Box3& box, std::vector<uint32_t>& out) const;

 private:
  // Cells [lo, hi] of a box along each axis; false where it lies outside.
  bool cells_of(const Box3& box, std::array<int, 3>& lo, std::array<int, 3>& hi) const;
  size_t cell(int i, int j, int k) const { return size_t(i) + size_t(n_[0]) * (size_t(j) + size_t(n_[1]) * size_t(k)); }

  std::vector<Box3> boxes_;
  Box3 all_;
  std::array<int, 3> n_{1, 1, 1};
  Vec3 scale_;
  std::vector<uint32_t> begin_, items_;
};

}  // namespace sg::swarm
