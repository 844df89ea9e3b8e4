// SPDX-License-Identifier: Apache-2.0
// The panel beside a volume's colour bar: opacity over the value, or a picture of a transfer function of two axes.
#pragma once
#include "render/annotate/legend/legend.h"

namespace sg {

/// Width of the panel (its height where the bar lies) and its texts, into `layout`. `legend.volume` must be there.
void plan_opacity(const Legend& legend, double font, LegendLayout& layout);

/// What the texts at the right of a lying panel take, with the gap before them.
double opacity_text_width(const Overlay& overlay, const LegendLayout& layout);

/// All on a chequerboard. One axis: the area under the opacity curve in the colours of its values, exactly; 0 at the left, the largest
/// opacity at the right. Two axes: each place of the plane in its colour, with its share of the largest opacity; widgets outlined. With
/// colour by another field the columns are the values that decide on opacity. Where the bar lies, what is said of columns holds for rows
/// from the lowest to the highest one.
void draw_opacity(Image& image, Overlay& overlay, const Legend& legend, const LegendLayout& layout);

}  // namespace sg
