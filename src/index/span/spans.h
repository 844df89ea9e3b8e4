// SPDX-License-Identifier: Apache-2.0
// Spans: from the lowest to the highest value in each of many items, a cell, some cells in a row, or a cube of a lattice. The indexes in
// this folder find the items that a value crosses without a look at the others.
#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Item i runs from lo[i] to hi[i], rounded outward to f32; lo > hi: it has no values.
struct Spans {
  std::vector<float> lo, hi;
  size_t size() const { return lo.size(); }
  /// An item is active when it has values on both sides: below the value, and at or above it (the side that contours call inside).
  static bool active(float lo, float hi, double value) { return double(lo) < value && value <= double(hi); }
  bool active(size_t i, double value) const { return active(lo[i], hi[i], value); }
};

/// Items are the cells of an unstructured or surface mesh, `group` consecutive ones each, by their points' `samples` (packed, one
/// component, one per point). NaN counts as no value. Throws an internal Error for other meshes. One parallel pass.
/// `length_of_cells`: where to put the sum of hi - lo over the single cells.
Spans cell_spans(const Dataset& mesh, const Array& samples, size_t group, const Context& context, double* length_of_cells = nullptr);

}  // namespace sg
