// SPDX-License-Identifier: Apache-2.0
// Colour maps that are straight between a few published places.
#pragma once
#include <span>

#include "color/colormap.h"

namespace sg {

struct ColorStop {
  float position;
  Vec3f color;  ///< sRGB
};
struct SegmentMap {
  std::string_view name;
  MapKind kind;
  std::string_view about;  ///< one sentence, with the source
  std::span<const ColorStop> stops;
};
std::span<const SegmentMap> segment_maps();

/// With `positions` where the stops do not lie evenly.
Colormap colormap_of(const SegmentMap& map);

}  // namespace sg
