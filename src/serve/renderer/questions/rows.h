// SPDX-License-Identifier: Apache-2.0
// What a window asks about the numbers of a step as a table.
#pragma once
#include "base/text/json.h"
#include "data/dataset.h"

namespace sg::serve {

/// "rows": points or cells with their fields, 500 at most; those of all parts of a collection one after the other, each with the name of
/// its part, and nothing in the columns of fields that the part lacks.
Json::Members answer_rows(const Json& question, const Data& data);

}  // namespace sg::serve
