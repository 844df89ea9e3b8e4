// SPDX-License-Identifier: Apache-2.0
// Parameters whose values are colours: their units say so, for windows that let a colour be picked.
#pragma once
#include "base/schema/schema.h"

namespace sg {

/// Of a word: a colour of the screen (#rrggbb, a name, or red,green,blue). Of three numbers: those of the screen, from 0 to 1.
inline constexpr const char* color_unit = "color";
/// Three numbers, red, green and blue, in proportion to the light.
inline constexpr const char* linear_color_unit = "linear color";

inline bool is_color(const ParamDecl& d) { return d.unit_ == color_unit || d.unit_ == linear_color_unit; }

/// "a number", or with what it is measured in "a number in deg".
inline std::string number_text(const ParamDecl& d) {
  return d.unit_.empty() || d.unit_[0] == '@' || is_color(d) ? "a number" : "a number in " + d.unit_;
}

}  // namespace sg
