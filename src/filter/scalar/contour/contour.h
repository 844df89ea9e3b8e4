// SPDX-License-Identifier: Apache-2.0
// contour: isosurfaces of a point field on 3D meshes, isolines on 2D ones.
#pragma once
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

/// On grids: of the surface in a cell.
enum class ContourTopology { trilinear, fixed };
constexpr auto enum_words(ContourTopology) {
  using enum ContourTopology;
  return std::array{Word{"trilinear", trilinear}, Word{"fixed", fixed}};
}

struct ContourParams {
  FieldName field;
  std::vector<double> values;
  int count = 1;
  bool normals = true;
  double tolerance = 1e-3;
  std::string component;
  ContourTopology topology = ContourTopology::trilinear;
  bool from_cells = false;
};
void describe(Schema& s, ContourParams& p);

/// The surface mesh where the field equals each value: triangles where cells are solids, lines where they are faces.
///
/// Input: uniform, rectilinear and curvilinear grids with two or three axes; unstructured meshes of any cells; surface meshes; AMR
/// grids, also by a field of their cells, whose leaves are joined across levels without cracks. Quadratic, Lagrange and Bezier cells are
/// divided until the triangles lie within `tolerance` (a share of the mesh's diagonal) of the true surface, on which all points lie. A
/// sample counts as inside when it is >= the value. There is exactly one point per cut cell edge, also where a sample equals the value
/// (points may then coincide). Surfaces are closed up to the border of the mesh and every edge has two triangles, wound like the
/// neighbour's. On grids the surface in each cell has the topology of the trilinear function: faces that can be cut in two ways by the
/// asymptotic decider (Nielson and Hamann 1991), tubes through cells (trilinear_cell.h); cells with a tube or a long loop have points
/// inside, which follow those on edges. Ties, also at saddles, count as inside: the surface is that of a value lower by less than any
/// number. topology=fixed: marching cubes' single table, in which inside corners are separated on every ambiguous face; it is closed too,
/// but its number of parts and handles may be wrong. Triangles and the point field "Normals" (f32, unit) face the smaller values; on lines
/// the larger values lie on the left in x-y meshes. Cells that touch a NaN or a hidden point, and ghost and blanked cells, leave clean
/// borders. All fields are carried: point fields interpolated along the edges and trilinearly inside cells (the contoured field itself is
/// the isovalue exactly, f32 for integer fields), cell fields from the cell. With several values, which may come in any order, the surfaces
/// are stored one after the other and the cell field "contour value" identifies them. Nothing crossed: an empty mesh with its fields, and a
/// note in the log. from_cells contours a cell field by its averages at the points (cell_to_point); a point field of the same name is left
/// out. Memory: less than one byte per sample besides the result (with more than eight values, at most a bit per sample and value up to 256
/// MB). Several values share one pass over a grid. Same bytes for any number of threads. Throws Error(usage) for an unknown field, a cell
/// field, a vector without `component`, and meshes without an interior.
DatasetPtr contour(const DatasetPtr& input, const ContourParams& params, Context& context);

/// The isovalues that contour() chooses where none are stated, over all parts of the data (data/ranks/over_all.h). Throws what it throws.
std::vector<double> choose_isovalues(const Dataset& input, const ContourParams& params, const Context& context);

}  // namespace sg
