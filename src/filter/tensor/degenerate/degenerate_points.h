// SPDX-License-Identifier: Apache-2.0
// Degenerate points of tensor fields in the plane: where the two eigenvalues are equal and lines of both families meet.
#pragma once
#include "filter/tensor/tensor_field.h"

namespace sg {

struct DegeneratePointsParams {
  TensorSource tensors;
};
void describe(Schema& s, DegeneratePointsParams& p);

/// The exact zeros of half the difference of the diagonal, f = (Tuu - Tww) / 2, and of g = Tuw, in the plane of each cell: of the linear
/// interpolant of triangles, the bilinear one of quads and pixels; other polygons are cut into triangles. Of 3D tensors on surfaces and
/// cuts only the part in the surface counts. With delta = f_u g_w - f_w g_u (Delmarcelle, Hesselink 1994): delta < 0 a trisector of tensor
/// index -1/2, delta > 0 a wedge of index +1/2. Points on shared edges are given once.
///
/// A PointCloud (f64) with "index" (-0.5, 0.5), "type" (labels: 0 trisector, 1 wedge), "delta", "eigenvalue" (the one there is),
/// "separatrices" (how many lines of the larger eigenvalue end in the point: 3 at a trisector, 1 or 3 at a wedge), "separatrix 1" to "3"
/// (unit vectors along them, NaN where there are fewer) and "original_cell". Cells where f and g vanish throughout are counted in a note.
/// Throws Error(usage) for solids (slice them; degenerate_lines finds theirs), lines and points.
DatasetPtr degenerate_points(const DatasetPtr& in, const DegeneratePointsParams& p, Context& ctx);

}  // namespace sg
