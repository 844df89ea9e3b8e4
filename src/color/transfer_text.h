// SPDX-License-Identifier: Apache-2.0
// Transfer functions as text: points and colour stops, read and written.
//
// A place on an axis is a position (0 = its low end, 1 = its high end, along the scale: 0.5 of 1..100 on a log scale is 10) or, with @
// before it, a value of the field: "0.3:0.1" and "@-500:0". Places must ascend; two points at one position make a step.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "color/color_scale.h"

namespace sg {

/// A place as a position on the axis: NaN for what a log scale cannot hold, nothing for what is not a number.
std::optional<double> place_position(std::string_view text, const ColorScale& axis);
/// The value at a place, exactly the one written after an @.
double place_value(std::string_view text, const ColorScale& axis);

/// "0:0,@200:0.1,1:0.8": opacities in [0,1]; a single number is a constant one. Between positions opacity is straight along the scale,
/// between two @values over the values. `word` is the parameter's name for messages. Throws Error(usage).
OpacityCurve parse_opacity(const std::string& text, const ColorScale& axis, const std::string& word = "opacity");
/// "@-500:0,@200:0.4": parse_opacity() reads it back exactly on every axis.
std::string opacity_text(const OpacityCurve& curve);

/// "0:#000000,0.4:tomato,1:white" into scale.map; the scale then goes from the first to the last place, unless `keep_range`. Throws
/// Error(usage).
void parse_color_stops(const std::string& text, ColorScale& scale, bool keep_range);
/// "@0:#000000,..." of a map, with as few stops as keep every colour of 8 bits; parse_color_stops() reads it back.
std::string color_stops_text(const ColorScale& scale);

}  // namespace sg
