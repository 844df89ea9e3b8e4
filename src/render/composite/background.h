// SPDX-License-Identifier: Apache-2.0
// What lies behind everything: a flat colour or a vertical gradient.
#pragma once
#include "image/image.h"
#include "scene/scene.h"

namespace sg {

/// Puts the scene's background under the premultiplied frame, which then is opaque; nothing for a transparent scene. The gradient is
/// even in sRGB, from `background` in the lowest to `background_top` in the highest row.
void composite_background(const Scene& scene, Frame& frame);

/// Linear colour of the background behind a row of a picture or of a band of it, whether or not it is painted.
Vec3f background_of_row(const Scene& scene, const Projection& projection, int row);

}  // namespace sg
