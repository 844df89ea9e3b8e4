// SPDX-License-Identifier: Apache-2.0
// Colour maps that people know by name from elsewhere, from the numbers that their authors published.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "color/colormap.h"

namespace sg {

struct PublishedMap {
  std::string_view name;
  MapKind kind;
  std::string_view about;   ///< one sentence, with the source
  std::string_view colors;  ///< evenly spaced, "rrggbb" each
};
std::span<const PublishedMap> published_maps();

/// sRGB in [0,1].
std::vector<Vec3f> colors_of(const PublishedMap& map);

}  // namespace sg
