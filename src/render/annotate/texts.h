// SPDX-License-Identifier: Apache-2.0
// Texts at places of the scene, such as the numbers of contour lines.
#pragma once
#include <vector>

#include "render/annotate/overlay/overlay.h"
#include "scene/camera.h"
#include "scene/scene.h"

namespace sg {

/// Angle of a text on the picture, radians anticlockwise, above -90 up to 90 degrees: that of its world direction as it is seen.
double text_angle(const TextItem& text, const Projection& projection);

/// Writes the texts, each in the middle of its place and turned, where they touch none of `taken`, no other text and not the border of
/// the projection's picture; adds what it wrote to `taken`.
void draw_texts(Overlay& overlay, const std::vector<TextItem>& texts, const Projection& projection, double font, std::vector<Rect>& taken);

}  // namespace sg
