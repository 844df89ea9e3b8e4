// SPDX-License-Identifier: Apache-2.0
// Rays through uniform and rectilinear grids, cell by cell: in each the trilinear field along the ray is a cubic.
#pragma once
#include <memory>

#include "render/volume/medium/stretch.h"
#include "render/volume/sources/lattice/lattice_volume.h"

namespace sg::volume {

/// Point samples: cubics of the trilinear cells, exactly. Cell fields: trilinear between the middles of the cells; next to a cell without a
/// value the mean of the corners that have one, as the cubic through four points. Labels: constant around each sample. `second`: another
/// field of the same grid, for RayField::second; may be null.
std::unique_ptr<RaySource> lattice_source(std::shared_ptr<const Volume> volume, std::shared_ptr<const Volume> second = nullptr);

}  // namespace sg::volume
