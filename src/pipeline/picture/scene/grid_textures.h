// SPDX-License-Identifier: Apache-2.0
// Pictures on surfaces out of files of data: a grid of one layer, by its own colours or coloured by its field.
#pragma once
#include "base/context.h"
#include "scene/show/picture.h"
#include "scene/show/varying_material.h"

namespace sg {

/// Reads those of the files named as pictures which are no pictures (PNG, JPEG, Radiance HDR), into `show.grids`; tells which field colours
/// them. Throws Error for files that cannot be read or are no grid of one layer.
void read_grid_textures(PictureShow& show, const VaryingMaterial& material, Context& context);

}  // namespace sg
