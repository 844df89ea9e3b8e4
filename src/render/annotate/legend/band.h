// SPDX-License-Identifier: Apache-2.0
// A legend whose bar lies: at the top or the bottom of the picture.
#pragma once
#include "render/annotate/legend/legend.h"

namespace sg {

/// Title, glyph, panel of opacity, bar and numbers, one below the other; the names of labels in rows from left to right. Its upper left
/// corner is at (0, 0), see moved(). `length`: wanted for the bar or the list, at most `room` with what stands beside it. A list takes at
/// most `tallest` pixels.
LegendLayout layout_band(const Overlay& overlay, const Legend& scale, double length, double room, double tallest, double font, bool nan);

/// The same elsewhere, whole pixels on.
LegendLayout moved(LegendLayout layout, int dx, int dy);

}  // namespace sg
