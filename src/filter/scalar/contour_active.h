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
  bool row(size_t j, size_t k) const { return !touched(j, k).none; }
  /// As classify(): bit i of row r is set for samples >= value, looked at only where the value can pass; elsewhere the cubes say it.
  void classify(const Array& samples, uint64_t* bits, size_t words, Context& context) const;

 private:
  // The rows of cubes that a row of points belongs to.
  struct Touched {
    size_t row[4];
    int rows = 0;
    bool none = true;
  };
  Touched touched(size_t j, size_t k) const;

  const LatticeIndex& index_;
  std::array<size_t, 3> dims_;
  double value_;
  size_t words_ = 0;              // per row of cubes
  std::vector<uint64_t> active_;  // bit per cube
  std::vector<uint8_t> row_;      // whether a row of cubes has any
};

}  // namespace sg::contouring
