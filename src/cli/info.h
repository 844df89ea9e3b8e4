// SPDX-License-Identifier: Apache-2.0
// What is in a file, for people and for programs.
#pragma once
#include <string>

#include "data/dataset.h"
#include "data/series.h"

namespace sg {

/// Lines for a terminal: kind, sizes, cell types, bounds, a table of fields with type, association, range and NaN count.
/// `quick` leaves the ranges out, so that no value is touched.
/// `times` are those of the series that the data is a step of, or empty.
std::string info_text(const Data& data, const std::string& name, bool quick, const std::vector<double>& times = {});

/// {"kind","dims","points","cells","cell_types":{name:count},"bounds":[6],"fields":[{"name","association","type","components",
/// "range":[[min,max] per component],"nan"}],"times":[]}; a collection is {"kind":"collection","parts":[{"name",...}],"times":[]}, a table
/// {"kind":"table","columns":[{"name","type","rows","range"}]}.
/// Numbers read back exactly; an empty range or empty bounds is null.
std::string info_json(const Data& data, bool quick, const std::vector<double>& times = {});

/// Ranges over all steps: a table for people.
std::string series_text(const SeriesRange& range, const std::string& name, const std::vector<double>& times);
/// {"times":[],"bounds":[6],"fields":[{"name","association","steps","range","nan"}]}
std::string series_json(const SeriesRange& range, const std::vector<double>& times);

}  // namespace sg
