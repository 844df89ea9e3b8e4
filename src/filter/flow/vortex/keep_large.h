// SPDX-License-Identifier: Apache-2.0
// Leaves out the crumbs of extracted lines and surfaces.
#pragma once
#include <string_view>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Of what polylines() made: the lines at least this long. A note when none is.
DatasetPtr long_lines(const DatasetPtr& lines, double shortest, std::string_view who, const Context& context);
/// Of what components() made: those whose box has at least this diagonal; without their numbers.
DatasetPtr large_parts(const DatasetPtr& parts, double smallest, std::string_view who, const Context& context);

}  // namespace sg
