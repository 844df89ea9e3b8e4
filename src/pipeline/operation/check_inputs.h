// SPDX-License-Identifier: Apache-2.0
// What comes into an operation, against what its row of the table and its parameters take.
#pragma once
#include <span>

#include "pipeline/operation/operation.h"

namespace sg {

/// Throws Error(usage) naming the operation, what it takes, what it got and what would do, when an input is of a kind that the operation
/// does not take. Of a collection one part that is taken is enough: its other parts are for the operation (map_parts() leaves some out).
/// `first`: number of inputs[0] among the inputs of the operation.
void check_kinds(const Operation& operation, std::span<const Data> inputs, size_t first = 0);

/// check_kinds(), then check_fields().
void check_inputs(const Operation& operation, const Schema& schema, std::span<const Data> inputs);

}  // namespace sg
