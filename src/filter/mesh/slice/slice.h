// SPDX-License-Identifier: Apache-2.0
// Where planes and other surfaces cut a mesh.
#pragma once
#include "filter/mesh/slice/implicit_function.h"

namespace sg {

using SliceParams = ImplicitParams;

inline void describe(Schema& s, SliceParams& p) {
  describe_implicit(s, p);
  s("planes", p.planes, "Several planes at once, through the origin (default: the middle): xyz gives three orthogonal planes.");
  s("positions", p.positions, "With axis: several parallel planes at these coordinates.");
  describe_curved_tolerance(s, p.tolerance);
}

/// The cut of a plane through any mesh as a SurfaceMesh in f64: one polygon per solid cell (several where the plane leaves and
/// re-enters it), facing along the normal, sharing points with its neighbours; lines where it cuts 2D cells, vertices on
/// curves. Exact for linear cells and polyhedra. AMR: leaves
/// only. Ghost cells are left out. A face that lies in the plane belongs to the cell behind it; a plane that only touches the mesh
/// from behind takes the cell in front. Point fields are interpolated along edges, cell fields gathered, 'original_cell' added.
/// A plane that misses gives an empty surface with all fields, and a note. A box is cut plane by plane, exactly: the cuts end sharply at
/// its edges, where they share points, and face outward. Other shapes (see implicit_function.h; `surface`: a closed surface or a solid
/// mesh) are contoured at zero: triangles in solid cells whose points lie on the shape, found along the edges by root finding. Curved cells
/// are made linear first, to a tolerance (see tessellate). Several planes give one surface with a cell field 'plane'. Throws Error(usage)
/// for what implicit_function() refuses, positions without an axis, a PointCloud, 2^32 points or more. O(cells); a plane through a uniform
/// or rectilinear grid: O(cut cells + rows).
DatasetPtr slice(const DatasetPtr& in, const DatasetPtr& surface, const SliceParams& p, Context& ctx);
inline DatasetPtr slice(const DatasetPtr& in, const SliceParams& p, Context& ctx) { return slice(in, nullptr, p, ctx); }

}  // namespace sg
