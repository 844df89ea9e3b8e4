// SPDX-License-Identifier: Apache-2.0
// A bar of a round length, and a caption, at the lower edge of a picture.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "render/annotate/annotate.h"
#include "render/annotate/overlay.h"

namespace sg {

/// What a bar stands for: 1, 2 or 5 times a power of ten.
struct ScaleBar {
  double length, pixels;
};
/// The longest one of at most `most` pixels at the depth of a place; nothing where that is behind the viewer.
std::optional<ScaleBar> scale_bar(const Projection& projection, Vec3 at, double most);

/// Draws bar (lower right) and caption (lower middle) as the annotation asks for them; adds what it drew to `taken`.
void draw_foot(Overlay& overlay, const Annotation& annotation, const Projection& projection, double font, std::vector<Rect>& taken);

}  // namespace sg
