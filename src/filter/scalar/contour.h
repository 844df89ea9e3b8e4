// SPDX-License-Identifier: Apache-2.0
// contour: isosurfaces of a point field on 3D meshes, isolines on 2D ones.
#pragma once
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema.h"
#include "data/dataset.h"

namespace sg {

struct ContourParams {
  FieldName field;
  std::vector<double> values;
  bool normals = true;
  std::string component;
  std::string topology = "trilinear";
  bool from_cells = false;
};
void describe(Schema& s, ContourParams& p);

/// The surface mesh where the field equals each value: triangles where cells are solids, lines where they are faces.
///
/// Input: uniform, rectilinear and curvilinear grids with two or three axes; unstructured meshes of linear cells and polyhedra;
/// surface meshes. A sample counts as inside when it is >= the value. There is exactly one point per cut cell edge, also where a
/// sample equals the value (points may then coincide). Surfaces are closed up to the border of the mesh and every edge has two
/// triangles: faces that can be cut in two ways are decided by the bilinear function on them (Nielson and Hamann 1991). Triangles and
/// the point field "Normals" (f32, unit) face the smaller values; on lines the larger values lie on the left in x-y meshes.
/// Cells that touch a NaN or a hidden point, and ghost and blanked cells, leave clean borders.
/// All fields are carried: point fields interpolated along the edges (the contoured field itself is the isovalue exactly, f32 for
/// integer fields), cell fields from the cell. With several values the cell
/// field "contour value" says which. Nothing crossed: an empty mesh with its fields, and a note in the log.
/// Memory: less than one byte per sample beside the result. Same bytes for any number of threads.
/// Throws Error(usage) for an unknown field, a cell field, a vector without `component`, and meshes without an interior.
DatasetPtr contour(const DatasetPtr& input, const ContourParams& params, Context& context);

}  // namespace sg
