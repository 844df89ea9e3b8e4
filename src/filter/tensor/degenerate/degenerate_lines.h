// SPDX-License-Identifier: Apache-2.0
// Degenerate lines of tensor fields in space: where two of the three eigenvalues are equal.
#pragma once
#include "filter/tensor/tensor_field.h"

namespace sg {

struct DegenerateLinesParams {
  TensorSource tensors;
  double perturb = 1e-6;
  double min_gap = 0;
};
void describe(Schema& s, DegenerateLinesParams& p);

/// Lines along which a 3D tensor field has a double eigenvalue (Zheng, Pang 2004): the larger two are equal (planar) or the smaller two
/// (linear). All cells are cut into tetrahedra from their corner with the smallest point id, neighbours alike, with the tensor linear in
/// each; curved cells are made linear first (tessellate). The exact places on the faces (degenerate_face.h) are joined within each
/// tetrahedron along the tangent of the line.
///
/// Symmetric data has lines along edges and through corners of cells, where faces do not cut them: every tensor is changed by `perturb`
/// times its deviator's size, by numbers that depend only on the point's id; 0 switches that off. `min_gap` leaves out places
/// whose third eigenvalue differs by less than this share of the field's largest deviator.
///
/// A SurfaceMesh (f64) of poly-lines with the point fields "mode" (1 linear, -1 planar), "eigenvalue" (the double one), "single
/// eigenvalue", "axis" (its eigenvector), and the cell fields "type" (labels: 0 linear, 1 planar), "closed", "length". Ends inside, where
/// parts could not be joined, are counted in a note; a warning says when whole surfaces are degenerate, which give many short pieces.
/// Throws Error(usage) for meshes without solid cells and for 2D tensors.
DatasetPtr degenerate_lines(const DatasetPtr& in, const DegenerateLinesParams& p, Context& ctx);

}  // namespace sg
