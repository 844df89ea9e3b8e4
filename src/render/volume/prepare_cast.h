// SPDX-License-Identifier: Apache-2.0
// From a volume item to what rays need: checks, its source by the kind of mesh, its medium.
#pragma once
#include "base/context.h"
#include "render/volume/rays/cast.h"
#include "render/volume/sources/item_checks.h"
#include "render/volume/sources/lattice/lattice_volume.h"

namespace sg::volume {

/// `lattice` is the prepared volume of a uniform or rectilinear grid, else null and the mesh is read by cells.
CastVolume prepare_cast(const VolumeItem& item, uint32_t id, std::shared_ptr<const Volume> lattice, const Projection& projection,
                        const Knobs& knobs, Context& context);

/// The same of any item, with its checks. `lattice` becomes that of a uniform or rectilinear grid, else null. A grid without extent has no
/// source: nothing is drawn of it.
CastVolume prepare_volume(const VolumeItem& item, uint32_t id, const Projection& projection, const Knobs& knobs, Context& context,
                          std::shared_ptr<const Volume>& lattice);

}  // namespace sg::volume
