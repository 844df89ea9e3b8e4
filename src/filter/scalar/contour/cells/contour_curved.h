// SPDX-License-Identifier: Apache-2.0
// Isosurfaces of meshes with quadratic, Lagrange or Bezier cells. Inside filter/scalar only.
#pragma once
#include "base/context.h"
#include "data/dataset.h"

namespace sg::contouring {

/// Whether the mesh has cells with more nodes than corners.
bool has_curved_cells(const Dataset& dataset);

/// The surface (and, on faces, lines) of a point field on an unstructured mesh with curved cells. The field is what the cells' shape
/// functions make of it, rational ones too; cells are divided (CurvedSimplices) until flat triangles lie within `tolerance`, a share of
/// the mesh's diagonal, of the surface. All points lie on the true surface to rounding; normals come from the true gradient, the mean
/// of the cells at a point. Fields are evaluated in the cells. `samples`: one number a point. One dataset for all values.
DatasetPtr contour_curved(const DatasetPtr& input, const Field& field, const Array& samples, const std::vector<double>& values,
                          double tolerance, bool normals, Vec3 origin, Context& context);

}  // namespace sg::contouring
