// SPDX-License-Identifier: Apache-2.0
// The outline on the picture of the part of a box that lies between two depths.
#pragma once
#include <vector>

#include "scene/camera.h"

namespace sg::volume {

/// Convex polygon in pixels, counter-clockwise on a y-down picture.
using Polygon = std::vector<Vec2>;

/// `corners`: bit 0 of the number is the upper side along the first axis and so on (any parallelepiped, world). Depths above 0 in
/// perspective. Empty when nothing lies between.
Polygon slab_polygon(const Vec3 corners[8], double nearest, double farthest, const Projection& projection);

/// Pixels [first, last) of row y whose middle may lie in the polygon (none missing, at most one too many at each end).
void row_span(const Polygon& polygon, int y, int width, int& first, int& last);

}  // namespace sg::volume
