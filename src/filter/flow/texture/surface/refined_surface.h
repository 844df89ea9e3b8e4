// SPDX-License-Identifier: Apache-2.0
// A surface as triangles that are small enough to carry a texture at their points, and what lies across their edges.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Triangles of a surface, split until no edge is longer than `longest` (world length; 0: as they are). Edges are split in the middle and
/// alike from both sides, so that no gap opens. Point fields are interpolated, cell fields carried.
struct RefinedSurface {
  DatasetPtr dataset;        ///< a SurfaceMesh of triangles
  std::vector<Vec3> points;  ///< relative to `origin`
  Vec3 origin;
  std::vector<std::array<uint32_t, 3>> triangles;  ///< points; those at one place have one number here: the smallest
  std::vector<std::array<int32_t, 3>> across;      ///< triangle beyond the edge opposite each corner; -1: none
  double edge_length = 0;                          ///< mean over the triangles' edges
};

/// The longest edge of a surface that gets a texture of `density` samples along a diagonal; 0: its own. By default 400, or what makes
/// 150 000 to 300 000 triangles of it: a skin of many faces need not take ten seconds.
double textured_edge(const Dataset& surface, double diagonal, std::optional<double> density);

/// Throws Error(usage) when that would make more than `most` triangles.
RefinedSurface refine_surface(const DatasetPtr& surface, double longest, size_t most, Context& context);

}  // namespace sg
