// SPDX-License-Identifier: Apache-2.0
// The numbers beside a legend's bar.
#pragma once
#include <vector>

#include "render/annotate/legend/legend.h"

namespace sg {

/// The stated numbers, else round ones and the ends of the range, where they have room; of bands their limits, or every second, third, ...
/// of them. Letters of size `font`; `bar` and `lies` as in LegendLayout.
std::vector<LegendLayout::Tick> legend_ticks(const Overlay& overlay, const ColorScale& scale, const Rect& bar, bool lies, double font);

}  // namespace sg
