// SPDX-License-Identifier: Apache-2.0
// mip_source: volumes in memory, drawn from averages where cells are smaller than a pixel.
#pragma once
#include <memory>

#include "base/context.h"
#include "render/volume/medium/stretch.h"
#include "render/volume/sources/lattice/lattice_volume.h"

namespace sg::volume {

/// Rays of neighbouring pixels that lie farther apart than the samples miss what is between them: the far part of a volume in perspective
/// flickers. This source draws each place from the level of a pyramid of means (of 2 x 2 x 2 samples each; mip-mapping, Williams 1983)
/// whose voxels cover at most a pixel, blending from level to level without a jump, as volumes on disk are drawn (brick_tree.h). The
/// pyramid is kept with the dataset: 4/7 byte per sample, and bricks of what is drawn up to a third of the volume.
///
/// Values are averaged, then classified: correct where colour times opacity is nearly linear over the values that meet in a pixel; where
/// only a thin range of values is shown, averages may lie outside it, and many rays per pixel (--samples) are better.
///
/// Null where it would draw the same as the lattice: all voxels at least a pixel wide, labels, one layer. Throws Error(usage) for what it
/// cannot do: meshes other than uniform grids, cell fields, blanked cells, other kernels, second fields.
std::unique_ptr<RaySource> mip_source(const VolumeItem& item, const Volume* lattice, const Projection& projection, Context& context);
bool is_mip_source(const RaySource& source);

}  // namespace sg::volume
