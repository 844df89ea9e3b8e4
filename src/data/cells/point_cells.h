// SPDX-License-Identifier: Apache-2.0
// Which cells use a point, for any mesh.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "data/dataset.h"

namespace sg {

/// Cells of each point in ascending order, without hidden and refined cells; duplicates count. Memory: 8 bytes a point, 4 (meshes of
/// 2^32 cells and more: refused) a corner.
class PointCells {
 public:
  explicit PointCells(const DatasetPtr& dataset);
  std::span<const uint32_t> operator[](size_t point) const {
    return std::span(cells_).subspan(begin_[point], begin_[point + 1] - begin_[point]);
  }
  size_t points() const { return begin_.size() - 1; }

 private:
  std::vector<size_t> begin_;
  std::vector<uint32_t> cells_;
};

}  // namespace sg
