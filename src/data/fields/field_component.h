// SPDX-License-Identifier: Apache-2.0
// Which component of a field is meant: the check of numbers that users give.
#pragma once
#include <string_view>

#include "data/dataset.h"

namespace sg {

/// Throws Error(usage) where the field has no such component. They count from 0; below 0 is the only one, or the magnitude.
void check_component(const Field& field, int component, std::string_view where);

}  // namespace sg
