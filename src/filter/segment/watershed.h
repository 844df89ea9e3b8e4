// SPDX-License-Identifier: Apache-2.0
// Basins of an image by flooding.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct WatershedParams {
  FieldName field, markers;
  bool gradient = false;
  double min_depth = 0;
  int connectivity = 6;
  std::string name = "watershed";
};
void describe(Schema& s, WatershedParams& p);

/// Adds a label field (i32, i64 for labels beyond it): each sample belongs to the marker (or minimum) from which water reaches it first
/// when the level rises (Meyer 1994). Samples of one level are reached in order of their distance in steps from the basin, then of arrival:
/// the same for any number of threads. `gradient` floods the length of the gradient (central differences, per unit of length) instead of
/// the values.
///   markers    a label field; 0 is not a marker; the result has its labels
///   min_depth  without markers: a minimum counts if water in it rises by more than this before overflowing into a deeper one;
///              minima are numbered from the lowest
/// Samples without a value, and those that no water reaches, get 0. Values are compared in single precision. O(n log n), mostly O(n).
/// Uniform and rectilinear grids of less than 2^32 samples, point or cell fields.
DatasetPtr watershed(const DatasetPtr& in, const WatershedParams& p, Context& context);

}  // namespace sg
