// SPDX-License-Identifier: Apache-2.0
// What a mesh is made of: points, curves, surfaces or solids.
#pragma once
#include "data/dataset.h"

namespace sg {

/// The largest dimension of its cells: 3 solids, 2 surfaces (flat or curved), 1 curves, 0 points or no cells. Lattices: the axes with more
/// than one point.
int mesh_dimension(const Dataset& data);

}  // namespace sg
