// SPDX-License-Identifier: Apache-2.0
// Which faces of solid cells have no partner.
#pragma once
#include <vector>

#include "base/context.h"
#include "base/huge_allocator.h"
#include "data/mesh.h"

namespace sg {

/// Marks of all faces of all solid cells, cell after cell: face f of `cell` is at first_face(cell) + f.
struct FaceMarks {
  static constexpr size_t cells_per_chunk = 4096;
  std::vector<size_t> chunk_start;  ///< marks before each chunk of cells
  Plane<uint8_t> external;          ///< 1 = no other solid cell has this face
};

/// Faces with the same corners are one face, whatever the order of their nodes; one that two or more cells have is internal.
/// `states` (CellState per cell, or empty): cells that are gone have no faces, duplicates count as neighbours.
/// Two steps: the 64-bit hashes of all faces are XORed into a few slots per point, where partners cancel; then the faces of slots
/// that are not zero (those near the surface) are matched exactly. Unequal faces that cancel would need equal hashes: 2^-64 per pair.
/// Blocks of cells whose points have near numbers work in slots of their own that are joined where they overlap; cells in any order share
/// one array. O(faces), parallel, 32 to 64 bytes of scratch per point. Throws Error(usage) above 2^31 faces or 2^32 points.
FaceMarks match_faces(const UnstructuredMesh& mesh, const std::vector<uint8_t>& states, const Context& ctx);

}  // namespace sg
