// SPDX-License-Identifier: Apache-2.0
// From the values at the nodes of a cell to the polynomials whose zeros BernsteinZeros finds.
#pragma once
#include "data/cells/shape/cell_shape.h"
#include "filter/flow/topology/zeros/bernstein_zeros.h"

namespace sg {

/// Of one kind of cell, in the box, triangle, tetrahedron or prism of its reference coordinates. The degree is the lowest that gives the
/// shape functions to 1e-9, at most three above the cell's order. Not thread-safe: one per thread.
class BernsteinBasis {
 public:
  explicit BernsteinBasis(const CellShape& shape);
  const CellShape& shape() const { return *shape_; }
  bool pyramid() const { return shape_->base() == CellType::pyramid; }

  /// The polynomials of these values at the nodes; `rational`: weights of the nodes, or empty.
  void set(std::span<const Vec3> at_nodes, std::span<const double> rational);
  /// Of a pyramid whose apex is a zero, that zero's whole upper face: divides the polynomials by 1 - z.
  void take_out_apex();
  /// As BernsteinZeros::solve; reference() turns the zeros into reference coordinates of the cell.
  bool solve(std::vector<Vec3>& zeros, std::span<const std::array<Vec3, 2>> known);
  /// A pyramid is a box whose upper face has shrunk to the apex; all others are as they are.
  Vec3 reference(Vec3 u) const;

 private:
  void fill(int degree);
  double misfit();

  const CellShape* shape_;
  ZeroDomain domain_;
  BernsteinZeros solver_;
  std::vector<double> matrix_;  // coefficients x nodes
};

}  // namespace sg
