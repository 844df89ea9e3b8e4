// SPDX-License-Identifier: Apache-2.0
// A few of a dataset's values in its place, where what is chosen from many datasets cannot have all of them in memory.
#pragma once
#include "data/dataset.h"

namespace sg {

/// A point cloud with the bounds and the ranges of `data` and all of its fields on points and cells, as fields of points: of each the
/// tuples with the least and the greatest component and magnitude, and others evenly spread over its values; `most` of these at most, and
/// fewer where the largest field has fewer. Fields of the whole dataset, and notes, are kept.
DatasetPtr sampled_cloud(const Dataset& data, size_t most);

}  // namespace sg
