// SPDX-License-Identifier: Apache-2.0
// Connected parts of a label image.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct LabelComponentsParams {
  FieldName field;
  double background = 0;
  std::vector<int64_t> labels;
  int connectivity = 6;
  bool by_label = true;
  int64_t min_size = 1;
  int keep = 0;
};
void describe(Schema& s, LabelComponentsParams& p);

/// Adds "component" (i32): 0 for background, NaN, hidden samples and parts that are dropped, 1 for the largest part and so on (equals in
/// order of their first sample), and the field of the whole "component sizes" (i64, samples). Samples of one label (or, without by_label,
/// of any wanted one) are connected over faces (6), edges too (18) or corners too (26; 4, 8 and 8 in a plane). Uniform and rectilinear
/// grids.
DatasetPtr label_components(const DatasetPtr& in, const LabelComponentsParams& p, Context& context);

/// The same on codes: number of each sample's part, 0 where code is 0, and the size of each part.
struct CodeComponents {
  std::vector<int32_t> component;
  std::vector<int64_t> size;
};
CodeComponents code_components(const int32_t* code, std::array<size_t, 3> dims, int connectivity, bool by_label, const Context& context);

}  // namespace sg
