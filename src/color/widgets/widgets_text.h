// SPDX-License-Identifier: Apache-2.0
// Widgets of transfer functions as text, read and written.
//
//   triangle LO HI BASE TOP [OPACITY [COLOR]]
//   rectangle LO HI LOW HIGH [OPACITY [COLOR]]
//   ellipse LO HI LOW HIGH [OPACITY [COLOR]]
//   paint RADIUS:RADIUS VALUE,SECOND [VALUE,SECOND ...] [OPACITY [COLOR]]
//
// separated by ';'. LO, HI and VALUE are places on the value's axis, the others on the second axis, as in transfer_text.h. The radii of a
// brush are shares of the ranges of the value and of the second axis, or with @ lengths on these axes: 0.05 of -1000..3000 is 200, on
// every kind of scale. OPACITY is 1 where none is given, COLOR "map", that of the value.
#pragma once
#include <string>
#include <vector>

#include "color/color_scale.h"
#include "color/widgets/transfer_widget.h"

namespace sg {

/// Throws Error(usage).
std::vector<TransferWidget> parse_widgets(const std::string& text, const ColorScale& value, const ColorScale& second);
/// All places as @values: parse_widgets() reads it back exactly on every axis.
std::string widgets_text(const std::vector<TransferWidget>& widgets);

/// Whether a widget of the text has positions as well as @values on one axis, so that only data can decide which of its ends is the lower.
bool mixes_ends(const std::string& text);

}  // namespace sg
