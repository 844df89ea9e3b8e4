// SPDX-License-Identifier: Apache-2.0
// Meshes whose cells share whole faces: what lines from cell to cell need.
#pragma once
#include <vector>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// An AMR grid of several patches as cells without hanging nodes (contouring::amr_cells_near), any other mesh as it is. Point fields are
/// those of the finest patch at each corner; of the fields of cells that `vectors` names (three components at most) there are point
/// fields besides, which keep linear fields linear; cells in which one of them is not finite are left out.
DatasetPtr with_whole_faces(const DatasetPtr& in, const std::vector<Field>& vectors, Context& context);

}  // namespace sg
