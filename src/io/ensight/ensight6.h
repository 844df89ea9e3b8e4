// SPDX-License-Identifier: Apache-2.0
// EnSight 6: nodes of all parts in one list, x y z of a node together, and variables in the same order. Source: EnSight User Manual,
// "EnSight6 Casefile Format".
#pragma once
#include "io/ensight/case_file.h"
#include "io/ensight/geometry.h"

namespace sg::ensight {

/// From the begin of a geometry file or of a step in it; each part has the nodes that its elements use. Throws Error(data).
Geometry read_geometry6(Stream& s, Context& context);

/// As read_variable(); real variables on nodes and elements.
void read_variable6(Stream& s, const Variable& v, const std::string& name, Geometry& geometry, bool look_only);

}  // namespace sg::ensight
