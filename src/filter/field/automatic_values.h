// SPDX-License-Identifier: Apache-2.0
// Values that operations choose when none are stated: round numbers within the range of all parts and pieces of the data.
#pragma once
#include <string_view>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// A round number within a tenth of the range about its middle; 0 for an empty range. Tells `who` chose it.
double middle_value(const Dataset& data, const Field& field, int component, std::string_view who, const Context& context);

/// About `count` values inside a range: the multiples of a round step (1, 2, 2.5 or 5 times a power of ten); one near the middle for a
/// count of 1, or the only value there is. None for an empty range.
std::vector<double> even_values(const Range& range, int count);

/// middle_value() for a count of 1, else even_values() of all parts and pieces. Tells `who` chose them.
std::vector<double> automatic_values(const Dataset& data, const Field& field, int component, int count, std::string_view who,
                                     const Context& context);

}  // namespace sg
