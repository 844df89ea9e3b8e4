// SPDX-License-Identifier: Apache-2.0
// The grid of the cell centres of a grid.
#pragma once
#include "data/mesh.h"

namespace sg {

/// Its points are the middles of the cells, in their order: uniform and rectilinear grids keep their kind, curvilinear ones take the mean
/// of the corners. An axis with one point keeps it. Throws an internal Error for a mesh that is not a lattice.
Mesh center_lattice(const Mesh& mesh);

}  // namespace sg
