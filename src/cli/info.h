// SPDX-License-Identifier: Apache-2.0
// What is in a file, for people and for programs.
#pragma once
#include <string>

#include "data/dataset.h"

namespace sg {

/// Lines for a terminal: kind, sizes, cell types, bounds, a table of fields with type, association, range and NaN count.
/// `quick` leaves the ranges out, so that no value is touched.
std::string info_text(const Data& data, const std::string& name, bool quick);

/// {"kind","dims","points","cells","cell_types":{name:count},"bounds":[6],"fields":[{"name","association","type","components",
/// "range":[[min,max] per component],"nan"}],"times":[]}; a collection is {"kind":"collection","parts":[{"name",...}]}.
/// Numbers read back exactly; an empty range or empty bounds is null.
std::string info_json(const Data& data, bool quick);

}  // namespace sg
