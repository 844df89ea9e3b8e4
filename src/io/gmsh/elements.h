// SPDX-License-Identifier: Apache-2.0
// Gmsh's element types and the order of their nodes.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "data/cells/cell_type.h"

namespace sg::gmsh {

struct ElementType {
  CellType shape = CellType::empty;  ///< linear type; empty = a type that is not read
  int order = 1;
  size_t nodes = 0;                 ///< in the file
  CellType cell = CellType::empty;  ///< what it becomes
  std::vector<uint32_t> from;       ///< of each node of the cell, its place in the file's list
};
/// Null for a number that is not a type, or a type without an equivalent cell of ours (high-order ones without inner nodes, pyramids above
/// order 2, cut and bordered elements). The 14-node pyramid loses the node in the middle of its base.
const ElementType* element_type(int64_t number);

/// Lattice places of the nodes of a complete element of order n in Gmsh's order. Source: Gmsh reference manual, "Node ordering".
std::vector<std::array<int, 3>> node_places(CellType shape, int n);

}  // namespace sg::gmsh
