// SPDX-License-Identifier: Apache-2.0
// The points of a mesh as a table, and what the columns of fields of several components are called.
#pragma once
#include <string>

#include "data/dataset.h"

namespace sg {

/// The points with their fields, one row each. First a field of the coordinates whose columns are x, y, z, or position_x, ... where a field
/// has one of these names; a field that repeats a coordinate under its name is left out.
TablePtr table_of_points(const Dataset& d);

/// The heading of a component: NAME of the only one, NAME_x, NAME_y, NAME_z of vectors of two or three, else NAME_0, NAME_1, ...; of
/// coordinates x, y, z. table_to_points() knows coordinates and vectors by these.
std::string column_name(const Field& f, int component);

}  // namespace sg
