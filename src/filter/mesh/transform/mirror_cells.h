// SPDX-License-Identifier: Apache-2.0
// What a mirrored mesh needs so that its cells are not inside out.
#pragma once
#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// The points of `parts` were mirrored (moved by a map of negative determinant): lists each cell of a plane or solid type the other way
/// round, so that volumes keep their signs, faces point outwards as they did and normals by the inverse transpose fit their polygons.
///   unstructured  nodes permuted by a reflection of the reference element, orders and weights kept; polyhedra: each face reversed
///   surface       polygons and strips reversed
///   lattices      if solid and now left-handed, or flat: points and cells in reverse order along an axis (those that descend, else the
///                 first), with all fields and ghost marks; uniform grids then have positive spacing
///   AMR           the same along each axis of negative spacing
/// A strip of an even number of triangles above two has no other way round: it becomes a triangle and a strip, with its fields at both.
/// Lines, points and clouds stay. Warns of curved cells whose number of nodes fits no order; they stay too.
void turn_mirrored_cells(DatasetParts& parts, Context& ctx);

}  // namespace sg
