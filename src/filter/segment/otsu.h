// SPDX-License-Identifier: Apache-2.0
// Thresholds that split the values of a field into classes.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct OtsuParams {
  FieldName field;
  int classes = 2;
  int bins = 4096;
  std::string name = "otsu";
};
void describe(Schema& s, OtsuParams& p);

/// The classes-1 thresholds that minimise the variance within classes (Otsu 1979), by dynamic programming over the histogram: the
/// optimum, not a local one. A value v gets the label "number of thresholds below v", so 0 is the darkest class; NaN and hidden samples
/// get 0. Integers of up to 65536 different values are counted one by one, others in `bins` equal bins. A threshold lies midway between the
/// occupied bins that it separates; of equally good splits the lowest is taken. Adds the field `name` (u8) and a field of the whole "NAME
/// thresholds"; logs them with the share of variance that they explain. Any mesh, point or cell field. Throws Error(usage) when the field
/// has fewer different values (after binning) than classes.
DatasetPtr otsu(const DatasetPtr& in, const OtsuParams& p, Context& context);

/// Values (ascending) and how often they occur.
struct ValueCounts {
  std::vector<double> value;
  std::vector<double> count;
};
/// One entry per occupied bin: the exact value, or the middle of the bin. NaN, infinite and, with states, not counted samples are left out.
ValueCounts value_counts(const Array& a, const std::vector<uint8_t>& states, int bins, const Context& context);
/// First entry of each class but the lowest: the split with the least variance within. O(classes n log n).
std::vector<size_t> best_split(const ValueCounts& h, int classes);

}  // namespace sg
