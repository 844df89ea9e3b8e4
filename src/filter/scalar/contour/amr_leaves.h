// SPDX-License-Identifier: Apache-2.0
// AmrLeaves: which cell of an AMR grid lies where, when only cells that are not refined count.
#pragma once
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "data/dataset.h"

namespace sg {

/// Places are counted in cells of the finest level (i64 an axis), so that all corners of all levels are whole numbers.
class AmrLeaves {
 public:
  using Place = std::array<int64_t, 3>;
  struct Leaf {
    int64_t cell = -1;  ///< number of the cell in the dataset; -1: there is none
    uint32_t level = 0, patch = 0;
    Place lo{};  ///< its lowest corner
  };

  /// Throws Error(usage) for levels whose common grid is beyond 2^40 cells along an axis.
  explicit AmrLeaves(const Dataset& dataset);

  const AmrGrid& grid() const { return grid_; }
  int dimension() const { return grid_.dimension; }
  /// Cells of the finest level along the side of a cell of this level.
  const Place& size(size_t level) const { return size_[level]; }
  /// The leaf that covers a cell of the finest level.
  Leaf at(const Place& cell) const;
  /// Whether this cell of a patch is a leaf: not refined, hidden or a duplicate.
  bool is_leaf(int64_t cell) const {
    return ghost_.count == 0 || !(ghost_[size_t(cell)] & (ghost_refined_cell | ghost_hidden_cell | ghost_duplicate));
  }
  /// Of a cell of the dataset; leaf or not.
  Leaf leaf(uint32_t level, uint32_t patch, size_t number_in_patch) const;
  Vec3 position(const Place& corner) const { return grid_.origin + unit_ * Vec3(double(corner[0]), double(corner[1]), double(corner[2])); }
  Vec3 center(const Leaf& leaf) const;

 private:
  struct Level {
    Place block{};  ///< patches are looked up by blocks of this many cells
    std::unordered_map<uint64_t, std::vector<uint32_t>> patches;
  };
  static uint64_t key(int64_t x, int64_t y, int64_t z) {
    return uint64_t(x) * 0x9E3779B97F4A7C15ull ^ (uint64_t(y) * 0xC2B2AE3D27D4EB4Full + 0x165667B19E3779F9ull) ^
           (uint64_t(z) * 0xD6E8FEB86659FD93ull + 77);
  }
  const AmrGrid& grid_;
  View<uint8_t> ghost_;
  std::vector<Place> size_;
  std::vector<Level> levels_;
  Vec3 unit_;
};

}  // namespace sg
