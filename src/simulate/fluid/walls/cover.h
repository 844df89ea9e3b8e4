// SPDX-License-Identifier: Apache-2.0
// Shares of boxes and of their faces that lie inside of a closed surface.
#pragma once
#include <vector>

#include "base/context.h"
#include "base/vec.h"
#include "simulate/fluid/mac_grid.h"

namespace sg::fluid {

/// Corners of triangles, three each. Holes are closed by nothing: a line that meets the surface an odd number of times is inside from its
/// last crossing to the end of the box.
using TriangleSoup = std::vector<Vec3>;

/// Of every place of the lattice of `axis` (faces across it; -1: cells) the share inside of the surface: exact along one direction, by
/// four lines along each other one. A flat grid is cut at the height of its origin.
template <class T>
Lattice<T> shares_inside(const TriangleSoup& surface, const MacGrid& g, int axis, const Context& context);

}  // namespace sg::fluid
