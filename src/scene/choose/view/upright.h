// SPDX-License-Identifier: Apache-2.0
// Which way is up for a shape of which the file does not say it.
#pragma once
#include <span>

#include "data/mesh.h"

namespace sg {

/// How well a shape stands on its lower side along an axis: the share of its shadow, the convex hull of all points seen from above, that
/// the hull of those takes which touch the ground (within a fiftieth of the shape's largest extent); 0 where the centre of the surface does
/// not lie above that hull, so that the shape would topple. Static stability is the first of the criteria of Fu, Cohen-Or, Dror and
/// Sheffer, "Upright orientation of man-made objects", SIGGRAPH 2008. Within [0, 1]; 0 without polygons.
double stability(std::span<const SurfaceMesh* const> parts, int axis);

}  // namespace sg
