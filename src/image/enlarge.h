// SPDX-License-Identifier: Apache-2.0
// A small image over a part of a larger one.
#pragma once
#include "image/image.h"

namespace sg {

/// Puts `part` over the pixels [x, x + width) x [y, y + height) of `whole`, linear between the middles of its pixels, to within 2.5/255.
/// Both have the same channels; the rectangle lies inside.
void paste_enlarged(const Image& part, int x, int y, int width, int height, Image& whole);

}  // namespace sg
