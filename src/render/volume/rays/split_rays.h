// SPDX-License-Identifier: Apache-2.0
// split_rays: rays of a pixel that subdivide where they would be farther apart than the cells.
#pragma once
#include <functional>
#include <vector>

#include "render/volume/sources/lattice/lattice_volume.h"

namespace sg::volume {

/// Depths between which a pixel has `finer` x `finer` rays.
struct RaySlab {
  double from, to;
  int finer;
};

/// Number of rays that the volumes of a scene with antialias=split need, by depth. In perspective rays diverge: one ray per pixel is enough
/// while a pixel covers at most a cell; beyond that each divides into four, and again at twice the depth (Kreeger, Bitter, Dachille, Chen,
/// Kaufman, "Adaptive perspective ray casting", IEEE Volume Visualization 1998). Slabs by rising depth, from the near to the far plane;
/// empty when one ray per pixel suffices everywhere. Ray functions of whole rays (a maximum, say) use the number needed at the far end
/// throughout, as do parallel projections.
///
/// At most 64 x 64 rays a pixel. The size of cells: the smallest edge of uniform and rectilinear grids, of other meshes the side of a
/// cube of their mean volume. Throws Error(usage) for volumes larger than memory.
std::vector<RaySlab> ray_slabs(const Scene& scene, const Projection& projection);

/// Casts the rays of a part of the picture: one ray a pixel, from its near to its far plane, before what is in the frame.
using CastPart =
    std::function<void(const Scene& scene, const Projection& part, const FragmentLists& fragments, Frame& frame, const Knobs& knobs)>;

/// Draws slab by slab from front to back, each as a finer picture of its own where light is left; rays hand on to those they divide into
/// what they have gathered, and a pixel is the mean of the last. The volumes' tolerances are shared out among the slabs.
void draw_in_slabs(const std::vector<RaySlab>& slabs, const Scene& scene, const Projection& projection, const FragmentLists& fragments,
                   Frame& frame, const Knobs& knobs, const CastPart& cast);

}  // namespace sg::volume
