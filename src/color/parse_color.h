// SPDX-License-Identifier: Apache-2.0
// Colours as text.
#pragma once
#include <string>
#include <string_view>

#include "base/vec.h"

namespace sg {

/// "#rrggbb", "#rgb", "r,g,b" with numbers from 0 to 1, or a name of CSS (css_colors.h). sRGB-encoded.
/// Throws Error(usage) naming `where` for anything else.
Vec3f parse_color(std::string_view text, std::string_view where);
/// "#rrggbb".
std::string color_text(Vec3f srgb);

}  // namespace sg
