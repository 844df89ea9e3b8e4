// SPDX-License-Identifier: Apache-2.0
// Random places in meshes, evenly by volume (3D), area (2D) or length (1D).
#pragma once
#include <functional>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Up to `count` places in the cells of the meshes' highest dimension, for which `inside` returns true; fewer when after 100 tries a place
/// there are not enough. `inside` empty: in any cell that is not hidden. Solids are first sampled by rejection in the box, which uses only
/// `inside`: it has to be false outside the mesh. Place i of a try depends on (seed, i) only.
std::vector<Vec3> random_places(const std::vector<DatasetPtr>& meshes, size_t count, uint64_t seed, const std::function<bool(Vec3)>& inside,
                                Context& context);

}  // namespace sg
