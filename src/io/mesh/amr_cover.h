// SPDX-License-Identifier: Apache-2.0
// Which cells of an AMR grid lie under finer ones.
#pragma once
#include "data/mesh.h"

namespace sg {

/// One u8 per cell of all patches: ghost_refined_cell where a patch of the next level lies on the cell (in whole or in part), else 0.
/// Levels touch by their `ratio`; O(cells + pairs of patches of neighbouring levels).
Array refined_cells(const AmrGrid& grid);

/// Sets cell_offset and point_offset of all patches from their boxes; returns the number of cells. Throws Error(data) when boxes run
/// backwards or there are more cells than can be counted.
size_t number_patches(AmrGrid& grid);

}  // namespace sg
