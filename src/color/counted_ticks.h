// SPDX-License-Identifier: Apache-2.0
// As many numbers beside a colour scale as are stated.
#pragma once
#include <vector>

#include "color/color_scale.h"

namespace sg {

/// tick_count numbers on the scale: round ones where some step gives so many, else at equal distances from end to end.
std::vector<TickLabel> counted_ticks(const ColorScale& scale);

/// Digits that tell the ends of a scale and what lies between them apart.
int digits_between(const ColorScale& scale);

}  // namespace sg
