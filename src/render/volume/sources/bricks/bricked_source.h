// SPDX-License-Identifier: Apache-2.0
// Rays through volumes larger than memory: bricks of the level that the picture can show, read when a ray needs them.
#pragma once
#include <memory>

#include "base/context.h"
#include "data/bricked.h"
#include "render/volume/medium/stretch.h"
#include "scene/scene.h"

namespace sg::volume {

/// Levels and bricks of a picture.
struct BrickedUse {
  std::vector<size_t> bricks;  ///< of each level, potentially visible: in the view and not transparent
  double voxel_pixels = 1;     ///< how many pixels a voxel may cover: 1 unless the budget asked for more
  uint64_t bytes = 0;          ///< of these bricks
};

/// A source for items whose dataset stands for a bricked volume (item.data->bricks()) and show its field; null for all others.
///
/// Each place is drawn from the coarsest level whose voxels cover at most `coarser` pixels there, or a coarser one where all bricks that
/// may be seen would have more than four times the bytes of the cache; so what is drawn depends on the view, the invisible values and
/// `memory`, never on threads or time. The field is continuous: next to a coarser brick a finer one blends linearly into the coarser level,
/// across its whole width. Stretches are exact cubics where one level is drawn; in the transition the cubic through four points (off by
/// less than 1/100 of the difference of the levels). Gradients: central differences of the level drawn. `memory`: bytes for bricks in
/// memory, 0 = 1 GiB; they stay with the dataset for the next picture. `coarser` = 8 gives a first picture at once, 1 the final one.
std::unique_ptr<RaySource> bricked_source(const VolumeItem& item, const Projection& projection, size_t memory, Context& context,
                                          double coarser = 1);
/// Of a source that bricked_source() gave, with its Invisible set.
BrickedUse bricked_use(const RaySource& source);

}  // namespace sg::volume
