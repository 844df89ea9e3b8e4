// SPDX-License-Identifier: Apache-2.0
// The fields that parameters name, against what their declarations take.
#pragma once
#include <span>
#include <string_view>

#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

/// Throws Error(usage) naming `who`, the parameter, the field and those that would do, when a parameter of type field names one that some
/// input has but none has in a kind that the parameter takes (ParamDecl::takes). A field of a whole dataset, and a name that no input
/// has, are left to the operation: 'none' may stand for itself.
void check_fields(std::string_view who, const Schema& schema, std::span<const Data> inputs);

}  // namespace sg
