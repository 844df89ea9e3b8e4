// SPDX-License-Identifier: Apache-2.0
// A source that computes a grid, as slabs: for volumes that no memory holds.
#pragma once
#include <string>
#include <vector>

#include "io/zarr/zarr.h"

namespace sg {

/// For sources with the parameters of analytic grids (dims, bounds) whose values depend only on position: each slab is a run of its own
/// with other dims and bounds. Others are computed whole. Throws Error(usage) for results that are not a uniform grid with a point field.
SlabSource slabs_of_source(const std::string& operation, const std::vector<std::string>& words, Context& context);

}  // namespace sg
