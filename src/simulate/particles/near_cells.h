// SPDX-License-Identifier: Apache-2.0
// Which cells of a mesh a short way may meet, by a coarse grid over it: most ways meet none.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "data/dataset.h"

namespace sg::swarm {

/// Shared and immutable.
class NearCells {
 public:
  /// Over surfaces and solids of any kind; `margin` is added to each cell's box on all sides.
  NearCells(const DatasetPtr& data, double margin);
  /// Whether anything on the way from a to b may be met; ways through more than `most_cells` cells of the grid may.
  bool may_meet(Vec3 a, Vec3 b, int most_cells = 64) const;
  /// Ids of all the mesh's cells that the way may meet, in any order, without duplicates, and perhaps of others. False where they are
  /// more than fit, where the way is long, or ghosts are among the cells: ask the whole mesh then.
  template <size_t N>
  bool collect(Vec3 a, Vec3 b, std::array<uint32_t, N>& ids, size_t& count) const {
    count = 0;
    return collect(a, b, std::span<uint32_t>(ids), count);
  }

 private:
  struct Part {  // of the grid: first and last cell along each axis
    int lo[3], hi[3];
    int cells() const { return (hi[0] - lo[0] + 1) * (hi[1] - lo[1] + 1) * (hi[2] - lo[2] + 1); }
  };
  bool part(Vec3 a, Vec3 b, Part& to) const;
  bool collect(Vec3 a, Vec3 b, std::span<uint32_t> ids, size_t& count) const;
  size_t row(int j, int k) const { return words_ * (size_t(j) + size_t(n_[1]) * size_t(k)); }
  // Bits of the 64 cells of a row's word that lie between two cells.
  static uint64_t between(int lo, int hi, size_t word) {
    const int first = lo - int(64 * word), last = hi - int(64 * word);
    if (last < 0 || first > 63) return 0;
    return (first <= 0 ? ~uint64_t(0) : ~uint64_t(0) << first) & (last >= 63 ? ~uint64_t(0) : ~(~uint64_t(0) << (last + 1)));
  }

  Box3 box_;
  std::array<int, 3> n_{};
  Vec3 scale_;
  size_t words_ = 1;              // of a row along x
  std::vector<uint64_t> filled_;  // a bit for each cell of the grid
  std::vector<uint32_t> rank_;    // filled cells before those of a word
  std::vector<uint32_t> begin_;   // of a filled cell's part of ids_; empty: ids are not known
  std::vector<uint32_t> ids_;
};

}  // namespace sg::swarm
