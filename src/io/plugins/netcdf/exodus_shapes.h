// SPDX-License-Identifier: Apache-2.0
// The element shapes of Exodus II: names, nodes, sides.
#pragma once
#include <span>
#include <string_view>

#include "io/mesh/node_order.h"

namespace sg::nc {

/// Corners of one side, in order.
using SideCorners = std::vector<uint8_t>;

enum class ShapeKind { fixed, polygons, polyhedra, points };

/// An element shape with a given number of nodes.
struct ExodusShape {
  ShapeKind kind = ShapeKind::fixed;
  CellType type = CellType::empty;  ///< the VTK type of highest degree for which the nodes suffice
  int dimension = 0;
  std::vector<uint8_t> order;          ///< node k of the type is node order[k] of the element
  std::span<const NodeMask> nodes;     ///< the element's nodes, as many as it has
  std::span<const SideCorners> sides;  ///< side 1, 2, ...
};

/// The shape of a name ("HEX8", "hex", "TRISHELL", "nsided") for elements of `nodes` nodes in `space` dimensions; without a
/// name, what fits the number of nodes. Throws Error(data) for an unknown name or too few nodes.
ExodusShape exodus_shape(std::string_view name, size_t nodes, int space);

}  // namespace sg::nc
