// SPDX-License-Identifier: Apache-2.0
// Where a value can pass, known from earlier contours of the same field. Inside filter/scalar only.
#pragma once
#include "filter/scalar/contour/contour_parts.h"
#include "index/span/active_index.h"

namespace sg::contouring {

/// Kept in the memo of a lattice.
struct LatticeIndex {
  StretchRanges ranges;
  std::vector<uint64_t> missing;  ///< bit of each sample that is NaN, in rows of whole words; empty when there is none
  size_t bytes() const { return ranges.lo.size() + ranges.hi.size() + missing.size() * 8; }
};

/// The index of the field under `key` (its name and component), made when this is not the first of the contours that were asked of it;
/// null before. `values`: how many are requested now; cells are looked at once for each (lattices once for all).
std::shared_ptr<const LatticeIndex> lattice_index(const Job& job, const std::string& key);
std::shared_ptr<const CellActiveIndex> cell_index(const Job& job, const std::string& key, size_t values);

}  // namespace sg::contouring
