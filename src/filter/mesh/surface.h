// SPDX-License-Identifier: Apache-2.0
// What a renderer needs of a surface: its triangles, its edges.
#pragma once
#include <cstdint>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// The dataset itself when it is a SurfaceMesh without ghost cells, else its external faces.
DatasetPtr surface_of(const DatasetPtr& in, Context& ctx);

struct Triangles {
  std::vector<uint32_t> indices;  ///< three point ids per triangle
  std::vector<uint32_t> cells;    ///< cell of the SurfaceMesh (vertices, lines, polygons, strips) per triangle; empty = its own number
  size_t count() const { return indices.size() / 3; }
  uint32_t cell(size_t triangle) const { return cells.empty() ? uint32_t(triangle) : cells[triangle]; }
};
/// Polygons and strips as triangles with the orientation of their cell; non-convex polygons by ear clipping. Parallel.
/// Throws Error(usage) for 2^32 points or more.
Triangles triangles_of(const SurfaceMesh& mesh);

/// Edges of polygons and strips, each once, as pairs (smaller id, larger id) in ascending order. Parallel.
std::vector<uint32_t> edges_of(const SurfaceMesh& mesh);

}  // namespace sg
