// SPDX-License-Identifier: Apache-2.0
// Colour maps of other programs that are not built in, and the nearest that is.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace sg {

struct MapElsewhere {
  std::string_view words;  ///< names, lower case without '_', '-' and blanks, with a space between two
  std::string_view here;   ///< the nearest built-in map
};
std::span<const MapElsewhere> maps_elsewhere();

/// The nearest built-in map of one that others call `name` (with or without _r at its end); "" for a name that none has.
std::string nearest_map(std::string_view name);

}  // namespace sg
