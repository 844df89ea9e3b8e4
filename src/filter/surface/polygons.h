// SPDX-License-Identifier: Apache-2.0
// Common base of the surface operations: the polygons of any mesh, their edges, and their orientation.
#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"
#include "filter/mesh/surface_builder.h"

namespace sg::surface {

/// The surface of any mesh with faces: a SurfaceMesh as it is (hidden and duplicate cells removed), the skin of solids, flat grids
/// as polygons. Strips become triangles. The patches of an AMR grid share their common points. An empty mesh stays one; throws
/// Error(usage) naming `who` for point clouds and meshes of points and lines only.
DatasetPtr polygon_surface(const DatasetPtr& in, std::string_view who, Context& ctx);

/// The same with triangles only (tessellate_face's split), and without vertices and lines.
DatasetPtr triangle_surface(const DatasetPtr& in, std::string_view who, Context& ctx);

/// Point ids as an i32 array; what polygon_surface gives has fewer than 2^31 points and corners.
template <class T>
Array id_array(const std::vector<T>& ids) {
  return Array::from_vector(std::vector<int32_t>(ids.begin(), ids.end()));
}

/// Positions of all points, in double.
std::vector<Vec3> positions(const Points& points);

/// For each point the first one at exactly the same place. NaN is a place of its own.
std::vector<uint32_t> equal_places(const std::vector<Vec3>& at);

/// The edges of polygons, each once, in order of (smaller point, larger point), with the sides that use it. A corner is a place in the
/// connectivity; the side from a corner to the next one of its polygon is named by the corner. Sides from a point to itself are left
/// out. Corners and polygons below 2^31.
struct Edges {
  struct Use {
    uint32_t corner, polygon;
    bool forward;  ///< runs from the smaller point to the larger
  };
  std::vector<uint32_t> lo, hi;  ///< points of each edge
  std::vector<uint32_t> begin;   ///< size()+1 entries into uses
  std::vector<Use> uses;         ///< in order of their corners within an edge
  size_t size() const { return lo.size(); }
  std::span<const Use> of(size_t edge) const { return std::span(uses).subspan(begin[edge], begin[edge + 1] - begin[edge]); }
};
Edges edges_of_polygons(const CellsView& polygons, size_t points);

/// Next and previous corner of the same polygon.
inline size_t next_corner(const CellsView& polygons, size_t polygon, size_t corner) {
  return corner + 1 == polygons.end(polygon) ? polygons.begin(polygon) : corner + 1;
}
inline size_t previous_corner(const CellsView& polygons, size_t polygon, size_t corner) {
  return (corner == polygons.begin(polygon) ? polygons.end(polygon) : corner) - 1;
}

/// Vector area of each polygon: along the normal, as long as the area.
std::vector<Vec3> vector_areas(const CellsView& polygons, const std::vector<Vec3>& at);

/// Which polygons to reverse so that neighbours agree.
struct Orientation {
  std::vector<uint8_t> flip;        ///< per polygon
  std::vector<uint32_t> component;  ///< per polygon: pieces joined by edges of two polygons
  std::vector<uint8_t> closed;      ///< per component: each of its edges has two of its polygons
  size_t flipped = 0;
  size_t one_sided = 0;  ///< components that have no orientation (Moebius strips)
};
/// Walks over edges that two polygons share; in each component the side that most polygons face (at a tie: the first one) stays. With
/// `outward`, closed components are turned so that the volume they enclose is positive.
Orientation orientation(const CellsView& polygons, const Edges& edges, const std::vector<Vec3>& at, bool outward);
/// The mesh with those polygons reversed; their first point stays the first.
SurfaceMesh oriented(const SurfaceMesh& mesh, const Orientation& o);

}  // namespace sg::surface
