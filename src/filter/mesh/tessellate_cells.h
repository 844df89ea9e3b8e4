// SPDX-License-Identifier: Apache-2.0
// Linear cells in place of curved ones.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct TessellateParams {
  double tolerance = 1e-3;
  int max_level = 5;
};
inline void describe(Schema& s, TessellateParams& p) {
  s("tolerance", p.tolerance, "Largest deviation of straight from curved cells, as a share of the mesh's size, and of a field's range.")
      .positive();
  s("max_level", p.max_level, "Maximum number of times an edge is halved.").range(0, 7);
}

/// Each quadratic, Lagrange or Bezier cell becomes linear cells of its kind (hexahedra 8 per halving, pyramids 6 pyramids and 4
/// tetrahedra), each edge halved equally often in the whole mesh, so that neighbours stay joined: often enough for positions and point
/// fields to be within the tolerance of the curved ones at the middles of the new edges, or max_level, or as often as there is room for
/// (2^23 pairs of a node and its weight, or what two halvings make): then a note gives the remaining distance.
/// Points on shared corners, edges and faces are shared. Linear cells, polygons and polyhedra pass through. Cell fields go to the
/// parts; 'original_cell' (i64) gives the source cell. Other mesh kinds come back as they are.
DatasetPtr tessellate(const DatasetPtr& in, const TessellateParams& p, Context& ctx);

}  // namespace sg
