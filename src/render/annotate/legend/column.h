// SPDX-License-Identifier: Apache-2.0
// A legend whose bar stands: at the left or the right side of the picture.
#pragma once
#include "render/annotate/legend/legend.h"

namespace sg {

/// One column with its right edge at area.right() or, at the left side, its left edge at area.x; in the middle of the area's height. The
/// bar takes its share of `whole` pixels as far as the area has room.
LegendLayout layout_column(const Overlay& overlay, const Legend& scale, const Rect& area, double whole, double font, bool nan);

}  // namespace sg
