// SPDX-License-Identifier: Apache-2.0
// Rays through curvilinear grids, unstructured meshes (linear, polyhedral and curved cells) and AMR grids.
#pragma once
#include <memory>

#include "base/context.h"
#include "render/volume/medium/stretch.h"
#include "scene/scene.h"

namespace sg::volume {

struct CellVolume;

/// A source for every mesh that is not a uniform or rectilinear grid. Throws Error(usage) for what has no volume (surfaces, points).
std::unique_ptr<RaySource> cell_source(const VolumeItem& item, Context& context);

/// Data behind such a source.
const CellVolume& cell_volume_of(const RaySource& source);

}  // namespace sg::volume
