// SPDX-License-Identifier: Apache-2.0
// The order of a cell's nodes, given by corners: a node in the middle of an edge, face or cell is known by the corners around it.
// Exodus II and CGNS number the corners as VTK does, but the nodes between them in other orders.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "data/cells/cell_type.h"

namespace sg {

/// Bit k is set when corner k is one of those in whose middle the node lies; a corner has only its own bit.
using NodeMask = uint8_t;

/// The nodes of a VTK type, linear to quadratic (lines, triangles, quads, tetrahedra, pyramids, wedges, hexahedra); empty for others.
std::span<const NodeMask> vtk_nodes(CellType type);

/// p with: node k of the VTK type is node p[k] of the file's. Empty when a node of the type is not in `file`.
std::vector<uint8_t> node_order(CellType type, std::span<const NodeMask> file);

/// A side (face or edge) of a cell given by its corners in order: its nodes in the order of the VTK type of highest degree for which
/// the cell has them all. `file` are the cell's nodes; places in it are returned. Sides of 1 to 4 corners.
struct CellSide {
  CellType type = CellType::empty;
  std::vector<uint8_t> nodes;
};
CellSide cell_side(std::span<const uint8_t> corners, std::span<const NodeMask> file);

}  // namespace sg
