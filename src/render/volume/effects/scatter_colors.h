// SPDX-License-Identifier: Apache-2.0
// Colours of volumes that scatter light.
#pragma once
#include "scene/items/volume_item.h"

namespace sg::volume {

/// The same item with the share of light that each collision scatters in place of its colours: those of which a thick body has these
/// colours in even light. In single scattering they are brighter and paler than the colours.
VolumeItem with_scatter_colors(VolumeItem item);

}  // namespace sg::volume
