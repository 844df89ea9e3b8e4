// SPDX-License-Identifier: Apache-2.0
// Triangles of a prepared item as plain lists, and fewer of them.
#pragma once
#include <cstdint>
#include <vector>

#include "render/prepare/prepared.h"

namespace sg::offline {

/// Colours of points or, with `per_cell`, of triangles (of segments): positions on the scale, or linear RGBA; both empty: one colour.
struct FlatColors {
  bool per_cell = false;
  std::vector<double> positions;
  std::vector<float> rgba;
};
/// Of the points or cells with these numbers.
FlatColors flat_colors(const raster::ColorSource& source, const std::vector<uint32_t>& numbers);

/// Points that triangles use, once each.
struct FlatSurface {
  std::vector<float> xyz;
  std::vector<uint32_t> triangles;
  std::vector<float> normals;     ///< three a point, or as many as `corners` name; empty: those of the faces
  std::vector<uint32_t> corners;  ///< normals of the triangles' corners; empty: those of the points
  FlatColors colors;

  size_t points() const { return xyz.size() / 3; }
};
FlatSurface flat_surface(const raster::PreparedItem& item);

/// The number of the part that each point lies in, from 0 in order of their first point; the box is cut into cubes, `parts` along its
/// longest axis. `count` receives how many there are.
std::vector<uint32_t> clusters_of(const std::vector<float>& xyz, int parts, size_t& count);

/// Points of a cluster become their mean, as do their colours (of labels the first) and normals; triangles that lose a corner are gone,
/// and those with the corners of another, turned alike (vertex clustering, Rossignac and Borrel 1993).
FlatSurface clustered(const FlatSurface& surface, int parts, bool labels);

}  // namespace sg::offline
