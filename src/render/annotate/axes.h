// SPDX-License-Identifier: Apache-2.0
// Numbered axes on the outer edges of a box, and the orientation triad.
#pragma once
#include <string>
#include <vector>

#include "render/annotate/annotate.h"
#include "render/annotate/overlay/overlay.h"

namespace sg {

/// An edge of the box that carries an axis.
struct BoxAxis {
  int axis = 0;   ///< 0 x, 1 y, 2 z
  Vec3 from, to;  ///< world; from has the smaller coordinate
  Vec2 outward;   ///< unit, on the picture, away from the box
};
/// At most one edge per axis, on the silhouette, preferring below and left; none for an axis that is seen end on, and none at
/// all when part of the box lies behind the viewer.
std::vector<BoxAxis> box_axes(const Box3& box, const Projection& projection);

/// Draws axes with ticks, numbers and names where they overlap none of `taken` and are not cropped; adds what it drew to `taken`.
void draw_box_axes(Overlay& overlay, const Annotation& annotation, const Projection& projection, double font, std::vector<Rect>& taken);

/// Place of the triad: lower left corner.
Rect triad_place(int width, int height, double font);
void draw_triad(Overlay& overlay, const Annotation& annotation, const Projection& projection, double font);

}  // namespace sg
