// SPDX-License-Identifier: Apache-2.0
// Where a plane cuts a mesh.
#pragma once
#include "base/context.h"
#include "base/schema.h"
#include "data/dataset.h"

namespace sg {

struct SliceParams {
  std::optional<Vec3> origin = {};
  Vec3 normal{0, 0, 1};
  std::string axis = "none";
  std::optional<double> position = {};
};

inline void describe(Schema& s, SliceParams& p) {
  s("origin", p.origin, "A point of the plane; default: the middle of the mesh.");
  s("normal", p.normal, "Direction across the plane.");
  s("axis", p.axis, "Short for a normal along x, y or z.").choices({"none", "x", "y", "z"});
  s("position", p.position, "With axis: the coordinate along it at which the plane lies; default: the middle.");
}

/// The cut of a plane through any mesh as a SurfaceMesh in f64: one polygon per solid cell (several where the plane leaves and
/// re-enters it), facing along the normal, sharing points with its neighbours; lines where it cuts 2D cells, vertices on
/// curves. Exact for linear cells and polyhedra; curved cells are cut as their corners span them (with a note). AMR: leaves
/// only. Ghost cells are left out. A face that lies in the plane belongs to the cell behind it; a plane that only touches the mesh
/// from behind takes the cell in front. Point fields are interpolated along edges, cell fields gathered, 'original_cell' added.
/// A plane that misses gives an empty surface with all fields, and a note. Throws Error(usage) for a zero normal, a position
/// without an axis, an axis with an origin or normal, a PointCloud, 2^32 points or more. O(cells); uniform and rectilinear: O(cut cells + rows).
DatasetPtr slice(const DatasetPtr& in, const SliceParams& p, Context& ctx);

}  // namespace sg
