// SPDX-License-Identifier: Apache-2.0
// Placeholders for field values that were not requested (ReadOptions::header_only): they have type and shape, but no byte is read.
#pragma once
#include "data/array.h"

namespace sg {

/// `count` tuples that all are the same NaN (0 for integers): one number in memory, stride 0.
Array unread_values(ElementType type, size_t count, int components = 1);

/// Whether a field of that name was requested (an empty list requests all).
bool is_wanted(const std::vector<std::string>& fields, std::string_view name);

}  // namespace sg
