// SPDX-License-Identifier: Apache-2.0
// Faces of non-conforming meshes: where a cell has smaller neighbours, its face lies against several of theirs.
#pragma once
#include "filter/mesh/faces/face_matching.h"

namespace sg {

/// Takes the marks off faces that have no partner with the same corners but lie in a larger face (triangle or quad, also a bent one) of
/// a cell on the other side, and off larger faces that are covered so. One that is covered in part only (some of the finer cells are
/// hidden) keeps its mark, as a whole. Found from the corners of the larger face on: the two sides must share these points by number,
/// as faces with equal corners must. Cells of high order are judged by their corners. O(faces with marks), parallel.
void unmark_hanging_faces(const UnstructuredMesh& mesh, FaceMarks& marks, const Context& ctx);

}  // namespace sg
