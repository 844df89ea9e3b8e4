// SPDX-License-Identifier: Apache-2.0
// CellNeighbors: which cell lies across each face (solids) or edge (2D cells) of each cell.
#pragma once
#include <cstdint>
#include <vector>

#include "base/context.h"
#include "data/mesh.h"

namespace sg {

/// Faces are numbered as in cell_faces() and CellFaceReader; a polyhedron's as the file lists them; edges of 2D cells go around
/// from corner 0 (pixels too: 0-1, 1-3, 3-2, 2-0). Other cells have none.
struct CellNeighbors {
  int fixed = 0;                ///< faces of every cell, when all have the same number
  std::vector<uint64_t> begin;  ///< else cells + 1 places in `across`
  std::vector<int32_t> across;  ///< the cell beyond, -1 for none

  size_t first(size_t cell) const { return fixed > 0 ? cell * size_t(fixed) : begin.empty() ? 0 : size_t(begin[cell]); }
  size_t count(size_t cell) const { return fixed > 0 ? size_t(fixed) : begin.empty() ? 0 : size_t(begin[cell + 1] - begin[cell]); }
  int64_t operator()(size_t cell, size_t face) const { return across[first(cell) + face]; }
};

/// Cells are neighbours when they share all corners of a face, whatever their order; repeated corners (collapsed cells) count once,
/// and a face that has collapsed to a line, or an edge to a point, has no neighbour. Where three or more cells meet, each names the
/// smallest other one. Unstructured and surface meshes (their polygons); the neighbours in a grid are arithmetic: Error(internal).
/// O(faces), parallel, the same for any number of threads; 24 bytes a face at its peak. Throws Error(usage) above 2^31 cells.
CellNeighbors cell_neighbors(const Mesh& mesh, const Context* context = nullptr);

}  // namespace sg
