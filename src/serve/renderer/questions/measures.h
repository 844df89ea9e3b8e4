// SPDX-License-Identifier: Apache-2.0
// Numbers of a part of the data: statistics and integrals of fields.
#pragma once
#include "base/text/json.h"
#include "serve/renderer/questions/selection.h"

namespace sg::serve {

/// The answer "measures" of a step's result: `field` alone, or all where it is "". Throws Error(usage) for tables and for fields that are
/// not there.
Json::Members measures_of(const Data& data, const Selection& selection, const std::string& field, Context& context);

}  // namespace sg::serve
