// SPDX-License-Identifier: Apache-2.0
// The tables of a collection as one.
#pragma once
#include "data/dataset.h"

namespace sg {

/// Does it hold tables, and nothing else?
bool all_tables(const Data& data);

/// The rows of all tables under each other, each after the name of its part in the first column, "part". Throws Error(usage) unless all
/// have the same columns.
TablePtr joined_tables(const Collection& collection);

}  // namespace sg
