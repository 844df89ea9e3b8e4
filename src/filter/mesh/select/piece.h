// SPDX-License-Identifier: Apache-2.0
// One part of a mesh that several processes share, with layers of ghost cells.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct PieceParams {
  int piece = 0;
  int pieces = 1;
  int ghost_levels = 0;
};

inline void describe(Schema& s, PieceParams& p) {
  s("piece", p.piece, "Piece to take, counted from 0.").at_least(0);
  s("pieces", p.pieces, "Number of pieces.").at_least(1);
  s("ghost_levels", p.ghost_levels, "Layers of neighbouring cells to add, marked as ghosts.").at_least(0);
}

/// Piece `piece` of `pieces`: the own cells of all pieces together are the cells of the mesh, each once. Grids are cut along their
/// longest axis and stay grids; point clouds by runs of point ids, other meshes by runs of cell ids. A ghost layer holds every cell that
/// shares a point with the layer before; its cells carry ghost_duplicate in cell_ghost. AMR: by runs of cell ids, as an UnstructuredMesh. A
/// piece without cells is an empty unstructured mesh (grids: null Dataset is never returned). Throws Error(usage) for a piece that is not
/// there.
DatasetPtr take_piece(const DatasetPtr& in, int piece, int pieces, int ghost_levels, Context& context);
/// The same for one of several processes: point_ghost marks the points that belong to other pieces, too, so that each is counted once. A
/// point belongs to the first piece with a cell at it. AMR with ghost layers: the whole, where all cells but the own are duplicates.
DatasetPtr take_share(const DatasetPtr& in, int piece, int pieces, int ghost_levels, Context& context);
inline DatasetPtr piece(const DatasetPtr& in, const PieceParams& p, Context& context) {
  return take_piece(in, p.piece, p.pieces, p.ghost_levels, context);
}

/// Each mesh as a collection of its pieces, named by their numbers, without those that have no cells; with 1 piece the data as they are.
Data in_pieces(const Data& data, int pieces, Context& context);

}  // namespace sg
