// SPDX-License-Identifier: Apache-2.0
// What is known of a time series without holding it: one step in memory at a time.
#pragma once
#include <string>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Statistics of one field over all steps and parts, by association and name.
struct SeriesField {
  std::string name;
  Association association = Association::point;
  FieldStats stats;  ///< ranges joined, NaN counts added
  size_t steps = 0;  ///< in how many steps it is there
};

/// Loads the steps one after the other, joins the ranges of each field and the bounds; holds one step at a time. Fields whose
/// number of components changes keep the ranges of the first. O(all data).
struct SeriesRange {
  std::vector<SeriesField> fields;  ///< in order of first appearance
  Box3 bounds;
  const SeriesField* find(std::string_view name, Association a) const;
};
SeriesRange series_range(const Series& series, Context& context);

/// Adds one step's fields (all datasets of the tree) to what is known.
void add_step(SeriesRange& range, const Data& step);

}  // namespace sg
