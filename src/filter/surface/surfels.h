// SPDX-License-Identifier: Apache-2.0
// Isosurfaces as small discs.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct SurfelsParams {
  FieldName field = {};
  std::optional<double> value = {};
  double size = 1;
};
inline void describe(Schema& s, SurfelsParams& p) {
  s("field", p.field, "Point field; default: the active scalar.").takes(fields::point_scalars);
  s("value", p.value, "Isovalue of the surface; default: the middle of the range.").unit("@field");
  s("size", p.size, "Radius of the discs, in half diagonals of a cell; 1 leaves no holes.").positive();
}

/// One disc for each cell of a grid of three axes that the surface field = value cuts: a point cloud with point fields
/// 'Normals' (f32, role normals, towards the smaller values) and 'radius' (f32, length). The points lie on the trilinear surface (two
/// Newton steps from the middle of the cell, held within it); other point fields are interpolated there, cell fields become point
/// fields. Cells with NaN or a hidden point and ghost cells have none. Nothing is shared or joined. Throws Error(usage) for other meshes
/// and cell fields. Order of the cells; the same bytes for any number of threads.
DatasetPtr surfels(const DatasetPtr& in, const SurfelsParams& p, Context& ctx);

}  // namespace sg
