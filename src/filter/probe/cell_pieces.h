// SPDX-License-Identifier: Apache-2.0
// CellPieces: a solid cell as tetrahedra on which its functions are taken to be linear.
#pragma once
#include <span>
#include <vector>

#include "data/cells/shape/cell_map.h"

namespace sg {

/// Corners of the pieces are points of the cell: their position and the weight of each node of the cell there. Linear cells and polyhedra:
/// the faces as fans around their middle, joined to the cell's middle (polyhedra must be star-shaped about the mean of their points).
/// Curved cells: the reference element divided until the nodes' integrals over the pieces depart from the cell's own by less than
/// `tolerance` of its volume, at most 4 divisions an order.
///
/// What is left of that difference is `correction`, per node and unit of the pieces' volume, so that
/// integral of node k's weight = sum over pieces + correction[k] * volume of the pieces is exact.
struct CellPieces {
  std::vector<Vec3> at;
  std::vector<double> rows;       ///< nodes numbers per corner
  std::vector<uint32_t> corners;  ///< four a piece
  std::vector<double> correction;
  size_t nodes = 0;

  /// Of the open cell of `map`, which is solid.
  void make(CellMap& map, double tolerance);

 private:
  void make_fans(CellMap& map);
  void make_divided(CellMap& map, int divisions);
  double compare(CellMap& map);
  uint32_t add(Vec3 p, std::span<const double> row);
  uint32_t add_mean(std::span<const uint32_t> of);
  std::vector<double> integral_, sum_, row_;
};

}  // namespace sg
