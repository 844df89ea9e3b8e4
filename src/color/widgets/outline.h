// SPDX-License-Identifier: Apache-2.0
// The outlines of widgets, to be drawn.
#pragma once
#include <vector>

#include "base/vec.h"
#include "color/widgets/transfer_widget.h"

namespace sg {

/// Lines of two points at least, in (value, second): the sides of a triangle or a rectangle, round an ellipse, and round all that a stroke
/// paints.
std::vector<std::vector<Vec2>> outline(const TransferWidget& widget);

}  // namespace sg
