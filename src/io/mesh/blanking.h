// SPDX-License-Identifier: Apache-2.0
// From blanked points of a lattice to blanked cells.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace sg {

/// Sets ghost_hidden_cell for each cell of an nx*ny*nz lattice that has a corner with a nonzero byte in `points`. Parallel.
void hide_cells(const std::array<size_t, 3>& dims, const uint8_t* points, uint8_t* cells);

/// Cells of a lattice of points: the product of max(n - 1, 1).
size_t lattice_cell_count(const std::array<size_t, 3>& dims);

}  // namespace sg
