// SPDX-License-Identifier: Apache-2.0
// Where a value can pass, known from earlier contours of the same field. Inside filter/scalar only.
#pragma once
#include "filter/scalar/contour_parts.h"
#include "index/span/active_index.h"

namespace sg::contouring {

/// Kept in the memo of a lattice.
struct LatticeIndex {
  ActiveIndex cubes;
  MinMaxBricks bricks;            ///< their ranges
  std::vector<uint64_t> missing;  ///< bit of each sample that is NaN, in rows of whole words; empty when there is none
  size_t bytes() const { return cubes.bytes() + bricks.ranges.size() * sizeof(MinMaxBricks::Range) + missing.size() * 8; }
};

/// The index of the field under `key` (its name and component), made when this is not the first of the contours that were asked of it;
/// null before. `values`: how many are asked for now; cells are looked at once for each (lattices once for all).
std::shared_ptr<const LatticeIndex> lattice_index(const Job& job, const std::string& key);
std::shared_ptr<const CellActiveIndex> cell_index(const Job& job, const std::string& key, size_t values);

/// Which words of a lattice's rows of bits a value can touch.
class ActiveWords {
 public:
  ActiveWords(const LatticeIndex& index, std::array<size_t, 3> dims, double value);
  /// Whether an edge at this row of points can be cut.
  bool row(size_t j, size_t k) const {
    const Near near = touched(j, k);
    bool any = false;
    for (size_t y = near.y0; y <= near.y1; ++y)
      for (size_t z = near.z0; z <= near.z1; ++z) any = any || row_[y + cubes_[1] * z];
    return any;
  }
  /// As classify(): bit i of row r is set for samples >= value, looked at only where the value can pass; elsewhere the cubes say it.
  void classify(const Array& samples, uint64_t* bits, Context& context) const;

 private:
  // The rows of cubes that a row of points belongs to: first and last along y and z. Points on the border of two belong to both.
  struct Near {
    size_t y0, y1, z0, z1;
  };
  Near touched(size_t j, size_t k) const {
    constexpr size_t edge = MinMaxBricks::edge;
    const size_t y = std::min(j / edge, cubes_[1] - 1), z = std::min(k / edge, cubes_[2] - 1);
    return {j % edge == 0 && y > 0 ? y - 1 : y, y, k % edge == 0 && z > 0 ? z - 1 : z, z};
  }
  // Whether a word of a row of points can hold both sides.
  void look(size_t j, size_t k, uint8_t* wanted) const;

  std::array<size_t, 3> dims_, cubes_;
  double value_;
  size_t words_;                 // per row of points
  std::vector<uint8_t> wanted_;  // a flag per word and row of cubes
  std::vector<uint64_t> sure_;   // the words of all points of a row of cubes, where that is not set
  std::vector<uint8_t> row_;     // whether a row of cubes has any active one
};

}  // namespace sg::contouring
