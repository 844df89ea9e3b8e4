// SPDX-License-Identifier: Apache-2.0
// Ranges and bounds of all pieces of a dataset, where processes share it: what is chosen from the data has to be the same for all of them.
// Collective calls (base/all_ranks.h); without Context::communicator, those of the dataset.
#pragma once
#include "base/context.h"
#include "data/dataset.h"

namespace sg {

Range over_all(const Range& mine, const Context& context);
Box3 over_all(const Box3& mine, const Context& context);
/// Dataset::range() of all pieces.
Range range_over_all(const Dataset& data, const Field& field, int component, const Context& context);
/// Dataset::bounds() of all pieces.
Box3 bounds_over_all(const Dataset& data, const Context& context);

}  // namespace sg
