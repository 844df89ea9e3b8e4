// SPDX-License-Identifier: Apache-2.0
// The skin of a mesh: what one sees of it from outside.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct FacesParams {
  double tolerance = 2.5e-4;
  bool original_cell = true;
  bool original_point = false;
};

inline void describe(Schema& s, FacesParams& p) {
  s("tolerance", p.tolerance,
    "Largest distance between curved cells and their triangles, as a share of the mesh's diagonal; for point fields four times that share "
    "of their range.")
      .positive();
  s("original_cell", p.original_cell, "Add the number of each face's input cell as cell field 'original_cell'.");
  s("original_point", p.original_point,
    "Add the number of each point's input point as point field 'original_point' (-1: a new point on a curved cell).");
}

/// External faces of any mesh as a SurfaceMesh. A face that two solid cells share disappears, also a large one with several small
/// ones against it (non-conforming meshes; points shared by number); 2D cells pass as polygons, curves
/// as lines, points as vertices. Faces point outward whatever the orientation of their cell. Curved faces and curves of
/// high-order cells are split by their own shape functions: edges into their order (1 to 10) times a power of two segments, at most
/// 32, as the tolerance asks (pieces shorter than four tolerances are not split), the same from both sides of a shared edge;
/// straight-sided ones with linear fields keep their nodes only. New points come after those of the mesh; integer, label and colour
/// fields take the value of the nearest node there. Hidden and refined cells are left out, so that the faces behind
/// them appear; duplicate ghost cells are left out too, but their shared faces stay internal. AMR: faces between a leaf and
/// anything that fills its neighbour's place, at its level, above or below, are internal; where finer cells fill only a part (some are
/// hidden), the whole face shows. Only used points are kept, in input order;
/// all fields are carried. A SurfaceMesh without ghost cells passes unchanged. O(faces), parallel.
DatasetPtr faces(const DatasetPtr& in, const FacesParams& p, Context& ctx);

/// The same, and the lines to draw as its edges where those are not the edges of its polygons: when curved faces became triangles,
/// `edges` is a SurfaceMesh over the same points whose lines are the cells' own edges, each once (no fields); else null.
struct Skin {
  DatasetPtr surface, edges;
};
Skin faces_and_edges(const DatasetPtr& in, const FacesParams& p, Context& ctx);

}  // namespace sg
