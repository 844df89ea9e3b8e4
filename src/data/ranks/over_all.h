// SPDX-License-Identifier: Apache-2.0
// Ranges and bounds of all pieces of a dataset, where processes share it, and of all parts of the collection to which it belongs
// (Context::parts): what is chosen from the data has to be the same for all of them. Collective calls (base/all_ranks.h); without a
// communicator and parts, those of the dataset.
#pragma once
#include "base/context.h"
#include "data/dataset.h"

namespace sg {

Range over_all(const Range& mine, const Context& context);
Box3 over_all(const Box3& mine, const Context& context);
/// Dataset::range() of all pieces and parts; of the other parts, that of the field of this name.
Range range_over_all(const Dataset& data, const Field& field, int component, const Context& context);
/// Dataset::bounds() of all pieces and parts.
Box3 bounds_over_all(const Dataset& data, const Context& context);

}  // namespace sg
