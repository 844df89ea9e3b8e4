// SPDX-License-Identifier: Apache-2.0
// resample: any mesh on a uniform grid.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

enum class ResampleMode { linear, conservative };
constexpr auto enum_words(ResampleMode) {
  using enum ResampleMode;
  return std::array{Word{"linear", linear}, Word{"conservative", conservative}};
}

struct ResampleParams {
  std::vector<int64_t> dims;
  int64_t size = 128;
  std::vector<double> bounds;
  ResampleMode mode = ResampleMode::linear;
  double tolerance = 1e-3;
};
inline void describe(Schema& s, ResampleParams& p) {
  s("dims", p.dims, "Number of points along x, y and z; default: from size.").at_least(1);
  s("size", p.size, "Number of points along the longest axis, the others in proportion.").range(2, 1e6);
  s("bounds", p.bounds, "Bounds as xmin,xmax,ymin,ymax,zmin,zmax; default: those of the mesh.").unit("length");
  s("mode", p.mode, "linear: values at the grid's points. conservative: averages over the grid's cells, which preserve integrals.");
  s("tolerance", p.tolerance,
    "conservative: largest distance, as a fraction of its size, between a curved cell and the straight pieces that represent it.")
      .range(1e-6, 1);
}

/// A UniformGrid over the box, fields and "valid" as in probe().
///
/// mode=conservative: cell fields on the grid instead. Each value is the integral of the field over the parts of the mesh's solid cells
/// that lie in the grid cell, over the grid cell's volume: 0 where there are none, and the sum of values times volume is the integral over
/// the mesh, as far as it lies in the box. Cell field "coverage": the covered part of each grid cell (1 = all; more where cells overlap).
/// Exact for tetrahedra and voxels: they are clipped. Other cells are cut into tetrahedra, finer until the volume or an edge departs by
/// less than `tolerance`; the difference of the pieces' integral to the cell's own (CellMap::integration_weights) is spread over the cell,
/// so that totals are exact. Integers become f32 (64-bit ones f64); a field's NaN spreads to the grid cells it touches. Throws Error(usage)
/// for boxes without extent, dims that fit no box, and conservative mode on a mesh without solid cells.
DatasetPtr resample(const DatasetPtr& input, const ResampleParams& params, Context& context);

/// The grid that the parameters request.
UniformGrid resample_grid(const Dataset& input, const ResampleParams& params);
/// mode=conservative.
DatasetPtr resample_conservative(const DatasetPtr& input, const UniformGrid& grid, double tolerance, Context& context);

}  // namespace sg
