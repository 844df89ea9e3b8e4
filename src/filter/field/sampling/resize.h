// SPDX-License-Identifier: Apache-2.0
// resize: a grid with other numbers of points, its fields by a reconstruction kernel.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "filter/field/sampling/reconstruction.h"

namespace sg {

struct ResizeParams {
  std::vector<int64_t> dims;
  Kernel kernel = Kernel::catmull_rom;
};
void describe(Schema& s, ResizeParams& p);

/// A uniform or rectilinear grid over the same box with dims points along x, y, z (or one number: along the longest axis, the others in
/// proportion). Axes of one point keep it. Point fields are read at the new points, cell fields at the new cells' middles, in index space,
/// by the product of three kernels (sampling/reconstruction.h). Along an axis that loses samples the kernel is widened by the ratio, so
/// that nothing is missed (then bspline does without its coefficients). Labels and ids take the nearest sample, and so do ghost marks.
/// Beyond the border samples are reflected as a point: what rises evenly is kept. A result has no value where the nearest sample has none
/// (NaN, hidden); others take made-up values for such samples, see fill_holes(). Types are kept; integers are rounded and clamped.
/// Throws Error(usage) for other meshes, unknown kernels and invalid dims.
DatasetPtr resize(const DatasetPtr& in, const ResizeParams& p, Context& context);

}  // namespace sg
