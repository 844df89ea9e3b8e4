// SPDX-License-Identifier: Apache-2.0
// Fills a FieldSampler at points or on a grid. For probe and resample.
#pragma once
#include <functional>

#include "base/context.h"
#include "data/lattice.h"
#include "filter/probe/field_sampler.h"

namespace sg {

/// Tuple i at point(i), for i < count. `scattered`: neighbours in the list are not neighbours in space, so they are visited in an order of
/// space; the result does not depend on it.
void sample_points(const DatasetPtr& from, size_t count, const std::function<Vec3(size_t)>& point, bool scattered, FieldSampler& out,
                   Context& context);

/// Tuple i at point i of an affine lattice whose axes lie along x, y and z. Meshes of cells are scan-converted: each cell writes the
/// points that it holds, cells in ascending order, the first one stays. The same answers as sample_points().
void sample_grid(const DatasetPtr& from, const LatticeView& grid, FieldSampler& out, Context& context);
/// Whether sample_grid() supports this lattice.
bool fits_sample_grid(const LatticeView& grid);

}  // namespace sg
