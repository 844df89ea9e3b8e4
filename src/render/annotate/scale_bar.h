// SPDX-License-Identifier: Apache-2.0
// A bar of a round length, and a caption, at the lower edge of a picture.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "render/annotate/annotate.h"
#include "render/annotate/overlay/overlay.h"

namespace sg {

/// What a bar stands for: 1, 2 or 5 times a power of ten.
struct ScaleBar {
  double length, pixels;
};
/// The longest one of at most `most` pixels at the depth of a place; nothing where that is behind the viewer.
std::optional<ScaleBar> scale_bar(const Projection& projection, Vec3 at, double most);

/// How a caption is set that may take a part of `width` pixels.
TextStyle caption_style(double font, double width);
/// Pixels at the lower edge of a picture that its caption takes; 0 without one.
double caption_height(const Overlay& overlay, const Annotation& annotation, double font, double width);

/// Draws the bar, in the lower right corner of what the projection shows, and the caption, in the middle of the overlay's lower edge, as
/// the annotation asks for them; adds what it drew to `taken`. `width`: as for caption_style().
void draw_foot(Overlay& overlay, const Annotation& annotation, const Projection& projection, double font, double width,
               std::vector<Rect>& taken);

}  // namespace sg
