// SPDX-License-Identifier: Apache-2.0
// Edges of cells that are about as small as pixels would be a dark surface: they fade.
#pragma once
#include <algorithm>
#include <cmath>

#include "render/prepare/prepared.h"

namespace sg::raster {

/// Edges with so many pixels of room are whole; those with `crowded` or less are gone.
constexpr double roomy_edge = 8, crowded_edge = 3;

inline double edge_fade(double room_pixels) { return std::clamp((room_pixels - crowded_edge) / (roomy_edge - crowded_edge), 0.0, 1.0); }

/// What is left of all edges where a share of them is gone, long ones not counted: those of the larger cells alone would look like a change
/// of the data.
inline double fade_together(size_t gone, size_t all) {
  constexpr double few = 0.25, many = 0.5;
  return std::clamp((many - double(gone) / double(std::max<size_t>(all, 1))) / (many - few), 0.0, 1.0);
}

/// The same of an item of edges that is seen with pixels of one world length.
inline double fade_together(const PreparedItem& edges, double pixel) {
  const SegmentSet& s = *edges.segments;
  const auto* xyz = reinterpret_cast<const float*>(edges.positions.raw());
  const auto place = [&](uint32_t point) { return Vec3(xyz[3 * size_t(point)], xyz[3 * size_t(point) + 1], xyz[3 * size_t(point) + 2]); };
  size_t gone = 0, kept = 0;
  for (size_t i = 0; i < s.count(); ++i)
    if (edge_fade(double(s.room[i]) / pixel) > 0) ++kept;
    else gone += length(place(s.points[2 * i + 1]) - place(s.points[2 * i])) < roomy_edge * pixel;
  return fade_together(gone, kept + gone);
}

}  // namespace sg::raster
