// SPDX-License-Identifier: Apache-2.0
// Expressions of the fields and places of a mesh as numbers at its points (filter/field/calc).
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "simulate/pde/mesh/simplices.h"

namespace sg::pde {

struct MeshNumbers {
  std::vector<double> at;  ///< one a point or a cell of the mesh
  bool of_cells = false;   ///< where the fields of the expression are
};

/// Throws Error(usage), naming `who`, for mistakes in the expression and where it gives several numbers.
MeshNumbers mesh_numbers(const DatasetPtr& mesh, const std::string& expression, double time, const std::string& who,
                         const Context& context);

/// One number a point of the simplices: of cells, the mean over those about it, by size; in the middle of polyhedra, that of their points.
std::vector<double> point_numbers(const Simplices& s, const MeshNumbers& numbers);
/// One number a simplex: that of its cell, or the mean of its points.
std::vector<double> simplex_numbers(const Simplices& s, const MeshNumbers& numbers);
/// 1 at points that are not 0 (nor NaN), or belong to a simplex of such a cell.
std::vector<uint8_t> marked_points(const Simplices& s, const MeshNumbers& numbers);

}  // namespace sg::pde
