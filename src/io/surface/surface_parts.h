// SPDX-License-Identifier: Apache-2.0
// What the surface formats (STL, PLY, OBJ) share when they write, and the merging of equal points when they read.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// The surface to write. Throws Error(usage) for other meshes: "extract its surface first".
const SurfaceMesh& surface_to_write(const Dataset& dataset, std::string_view format, const std::string& path);

/// Polygons and strips as triangles (fans and alternating strips), three point ids each; cells of fewer than 3 points vanish.
std::vector<int64_t> surface_triangles(const SurfaceMesh& mesh);

/// Polygons, and strips cut into triangles, as lists of point ids: offsets (size + 1) and ids. `source` gets the number of the
/// surface's cell that each one came from (vertices, lines, polygons, strips).
struct PolygonList {
  std::vector<int64_t> ids;
  std::vector<size_t> offsets{0};
  std::vector<size_t> source;
};
PolygonList surface_polygons(const SurfaceMesh& mesh);

/// Distinct points in the order of their first use, and for every corner the number of its point.
struct MergedPoints {
  Array xyz;  ///< f32, 3 components
  Array ids;  ///< i32, one per corner
};
/// Merges corners whose coordinates are equal (-0 equals 0). Corner i begins at `corners + i / 3 * triangle_stride +
/// i % 3 * 12` and is three little-endian floats, in any alignment. Parallel; the result depends only on the corners.
/// Throws Error(data) naming `where` and the triangle for coordinates that are not finite, and for more than 2^31 points.
MergedPoints merge_corners(const std::byte* corners, size_t count, size_t triangle_stride, const std::string& where, Context& context);

}  // namespace sg
