// SPDX-License-Identifier: Apache-2.0
// Lattices and AMR grids numbered the other way along some axes.
#pragma once
#include <array>

#include "data/dataset.h"

namespace sg {

/// turn_mirrored_cells() for lattices and AMR grids; other meshes stay.
void turn_mirrored_lattice(DatasetParts& parts);

/// A uniform or rectilinear grid numbered the other way along some axes, with its fields: the same points and cells in another order, its
/// spacing or coordinates along them turned round. Its extent begins at 0. Other meshes stay.
void number_backwards(DatasetParts& parts, std::array<bool, 3> axes);

/// An AMR grid with negative spacing along some axes is renumbered, with its fields, so that all are positive; indices of cells of
/// level 0 begin at 0 or above where they did. Other meshes stay.
void ascend_amr(DatasetParts& parts);

}  // namespace sg
