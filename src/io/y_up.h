// SPDX-License-Identifier: Apache-2.0
// Which formats hold graphics, in which y points up.
#pragma once
#include <string_view>

namespace sg {

/// Bits of Format::honours beside those of Honours (io.h): y points up, by custom or, with the second one, by the format's own definition.
inline constexpr unsigned y_is_up = 16, defines_up = 64;

/// Whether y points up in files of this extension ("obj").
bool y_points_up(std::string_view extension);
/// Whether the format itself says which way is up.
bool states_up(std::string_view extension);

}  // namespace sg
