// SPDX-License-Identifier: Apache-2.0
// The unit normal of a flat cell at a place.
#pragma once
#include "data/cells/shape/cell_map.h"

namespace sg {

/// Of the cell that `map` has open, at reference coordinates `rst` in it: from its Jacobian, of polygons by Newell's sum, of strips from
/// the triangle of the place (all turned as the first). Not finite where the cell has no area.
Vec3 surface_normal(const CellMap& map, Vec3 rst);

}  // namespace sg
