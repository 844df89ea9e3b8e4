// SPDX-License-Identifier: Apache-2.0
// Which cells may hold a zero, from the signs of the velocity at their points.
#pragma once
#include <cstdint>
#include <vector>

#include "filter/flow/flow_field.h"
#include "filter/flow/topology/zeros/plane_frame.h"

namespace sg {

/// Cells, ascending, none of whose components has one sign at all points. Right for weights between 0 and 1: cells of more nodes than
/// corners, and polygons and polyhedra that are not convex, are always among them. Grids: rows of sign bytes; others: their lists of
/// points. O(points + cells), parallel.
std::vector<uint64_t> cells_that_may_vanish(const FlowField& flow, const PlaneFrame* frame, Context& context);

}  // namespace sg
