// SPDX-License-Identifier: Apache-2.0
// Which formats hold graphics, in which y points up.
#pragma once
#include <string_view>

namespace sg {

/// A bit of Format::honours beside those of Honours (io.h).
inline constexpr unsigned y_is_up = 16;

/// Whether y points up in files of this extension ("obj").
bool y_points_up(std::string_view extension);

}  // namespace sg
