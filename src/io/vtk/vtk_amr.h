// SPDX-License-Identifier: Apache-2.0
// What covers what in overlapping AMR.
#pragma once
#include "data/dataset.h"

namespace sg::vtk {

/// One u8 per cell of the grid: ghost_refined_cell where the patches of the next level cover the whole cell, else 0.
Array refined_cells(const AmrGrid& grid);

}  // namespace sg::vtk
