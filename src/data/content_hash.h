// SPDX-License-Identifier: Apache-2.0
// A short text that tells the content of a dataset from any other.
#pragma once
#include <string>
#include <vector>

#include "data/dataset.h"

namespace sg {

/// 32 hexadecimal digits (XXH3-128) of the mesh, of what is hidden of it, and of these fields of the dataset with their names. Numbers
/// count, not where and how they lie: strides, owners, the width of indices and whether lists of cells have offsets make no difference;
/// types of numbers do. Computed once for a list of fields; O(bytes), two threads or more make it no faster.
std::string content_hash(const Dataset& data, const std::vector<const Field*>& fields);

}  // namespace sg
