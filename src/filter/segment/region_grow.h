// SPDX-License-Identifier: Apache-2.0
// Samples that are connected to seeds.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct RegionGrowParams {
  FieldName field;
  std::vector<double> seeds;
  std::optional<double> min, max;
  double confidence = 2.5;
  int rounds = 4;
  int connectivity = 6;
  std::string name = "region";
};
void describe(Schema& s, RegionGrowParams& p);

/// Adds a label field (u8): 1 for samples that are joined to a seed through samples with values in [min, max]. Without min and max the
/// range is mean -+ confidence deviations, first of the up to 27 samples around each seed, then `rounds` times of the region so far
/// (confidence-connected growing). Logs the range and the size. Uniform and rectilinear grids, point or cell fields. Throws Error(usage)
/// for no seed, seeds outside the grid, on samples without a value, or outside the range.
DatasetPtr region_grow(const DatasetPtr& in, const RegionGrowParams& p, Context& context);

}  // namespace sg
