// SPDX-License-Identifier: Apache-2.0
// Pictures on surfaces out of files of data: a grid of one layer, by its own colours or coloured by its field.
#pragma once
#include "base/context.h"
#include "scene/show/surface.h"

namespace sg {

/// Reads those of the files that `show` names as pictures which are no pictures (PNG, JPEG, Radiance HDR), into PictureShow::grids; tells
/// which field colours them. Throws Error for files that cannot be read or are no grid of one layer.
void read_grid_textures(SurfaceShow& show, Context& context);

}  // namespace sg
