// SPDX-License-Identifier: Apache-2.0
// The skin of a mesh: what one sees of it from outside.
#pragma once
#include "base/context.h"
#include "base/schema.h"
#include "data/dataset.h"

namespace sg {

struct FacesParams {
  bool original_cell = true;
  bool original_point = false;
};

inline void describe(Schema& s, FacesParams& p) {
  s("original_cell", p.original_cell, "Adds the number of the input cell to every face as cell field 'original_cell'.");
  s("original_point", p.original_point, "Adds the number of the input point to every point as point field 'original_point'.");
}

/// External faces of any mesh as a SurfaceMesh. A face that two solid cells share disappears; 2D cells pass as polygons, curves
/// as lines, points as vertices. Faces point outward whatever the orientation of their cell. Curved faces become triangles
/// through their nodes (Bezier faces are evaluated there). Hidden and refined cells are left out, so that the faces behind
/// them appear; duplicate ghost cells are left out too, but their shared faces stay internal. AMR: faces between a leaf and
/// anything that covers its neighbour, at its level or above, are internal. Only used points are kept, in input order;
/// all fields are carried. A SurfaceMesh without ghost cells passes unchanged. O(faces), parallel.
DatasetPtr faces(const DatasetPtr& in, const FacesParams& p, Context& ctx);

}  // namespace sg
