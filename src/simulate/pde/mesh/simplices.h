// SPDX-License-Identifier: Apache-2.0
// The cells of any mesh as segments, triangles or tetrahedra that meet in whole facets: what linear finite elements live on.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/context.h"
#include "base/vec.h"
#include "data/dataset.h"

namespace sg::pde {

/// Of the cells of the highest dimension. Polygons and quads are cut as everywhere (tessellate_face); hexahedra, wedges and other solids
/// into tetrahedra from their lowest point to the faces without it, faces by fans from their lowest point, so that neighbours cut a shared
/// face alike; polyhedra about an additional point in their middle. Simplices without extent are left out, and hidden cells.
struct Simplices {
  int dimension = 0;
  size_t points = 0;  ///< of the mesh; `at` holds the middles of polyhedra behind them
  std::vector<Vec3> at;
  std::vector<std::array<uint32_t, 4>> corners;  ///< dimension + 1 of them
  std::vector<uint32_t> cell;                    ///< of each simplex

  size_t size() const { return corners.size(); }
};

/// Throws Error(usage) naming `who` for meshes without lines, faces or solids, for AMR, for more than 2^32 points, and for more
/// cells than memory could hold.
Simplices simplices_of(const DatasetPtr& mesh, const std::string& who, const Context& context);

/// 1 for points on the border: of facets that belong to one simplex alone.
std::vector<uint8_t> border_points(const Simplices& s);

/// Length, area or volume of a simplex, and the gradients of its linear functions in its own plane. 0 where it has no extent.
double simplex_gradients(const Simplices& s, size_t simplex, std::array<Vec3, 4>& gradients);

}  // namespace sg::pde
