// SPDX-License-Identifier: Apache-2.0
// What a window asks about the values of a field along a straight line.
#pragma once
#include "base/context.h"
#include "base/text/json.h"
#include "data/dataset.h"

namespace sg::serve {

/// "line": at each place the value in the first part of the data that holds it; of clouds that of the nearest point of all, where no cell
/// holds it. Throws Error(usage) for a table, for a field that no part has, and for places that are none.
Json::Members answer_line(const Json& question, const Data& data, Context& context);

}  // namespace sg::serve
