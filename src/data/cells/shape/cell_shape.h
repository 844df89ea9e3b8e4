// SPDX-License-Identifier: Apache-2.0
// CellShape: reference element, shape functions N_k(r,s,t) and derivatives of every cell type with a reference map.
//
// Reference coordinates are VTK's: curves, quads and hexahedra on [0,1]^d; triangles r,s >= 0, r+s <= 1; tetrahedra r+s+t <= 1;
// wedges triangle(r,s) x [0,1](t); pyramids square base (r,s) in [0,1]^2 at t=0, apex (1/2,1/2,1). Bezier cells: Bernstein polynomials;
// with rational weights w_k: N_k w_k / sum_j N_j w_j. Polygons and polyhedra have no reference map: see data/cells/shape/cell_map.h.
#pragma once
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "base/vec.h"
#include "data/cells/cell_type.h"

namespace sg {

namespace basis {
struct Space;
}

/// One reference element. Made once per (type, nodes, orders) and kept; safe to share between threads.
class CellShape {
 public:
  /// Null for types without a reference map (polygon, polyhedron, strips, poly-lines, poly-vertices, quadratic_polygon, empty) and
  /// for node counts that fit no order. `orders` of 0 means the same along all axes, found from the node count.
  static const CellShape* find(CellType type, size_t nodes, std::array<int, 3> orders = {0, 0, 0});

  CellType type() const { return type_; }
  /// The linear type of the same form: tetra for a quadratic or Bezier tetrahedron.
  CellType base() const { return base_; }
  /// Orders along the axes; {1,1,1} for linear types, {2,2,2} for quadratic ones.
  std::array<int, 3> orders() const { return orders_; }
  int dimension() const { return dimension_; }
  size_t nodes() const { return nodes_; }
  /// Highest total degree of polynomials that are reproduced exactly (1 for linear cells, the smallest order for Lagrange).
  int degree() const { return degree_; }
  /// Reference position of node k.
  Vec3 node(size_t k) const { return at_[k]; }
  Vec3 center() const { return center_; }
  /// Length, area or volume of the reference element: 1, 1/2, 1/6 or 1/3.
  double reference_measure() const;

  /// N_k at (r,s,t), nodes() numbers. Sum 1; for Lagrange-like types N_k(node(j)) = [j == k].
  void values(Vec3 rst, double* n) const;
  /// dN_k/dr, dN_k/ds, dN_k/dt: 3 numbers a node (unused axes 0).
  void derivatives(Vec3 rst, Vec3* dn) const;
  /// Both at once, for less than twice the price.
  void functions(Vec3 rst, double* n, Vec3* dn) const;
  /// How far outside the reference element, in reference units; <= 0 inside.
  double outside(Vec3 rst) const;
  /// The nearest place of the reference element (exact for boxes, simplices and wedges, near for pyramids).
  Vec3 clamped(Vec3 rst) const;
  /// Quadrature of the reference element exact for polynomials of total degree `degree`; on boxes and along the axis of wedges,
  /// of degree `degree` in each coordinate (tensor Gauss-Legendre, collapsed (Duffy) on simplices and pyramids, where the rational
  /// functions of pyramids are integrated exactly too). Weights sum to reference_measure().
  struct Quadrature {
    std::vector<Vec3> at;
    std::vector<double> weight;
  };
  const Quadrature& quadrature(int degree) const;

 private:
  friend class CellShapeTable;
  CellShape() = default;
  CellType type_ = CellType::empty, base_ = CellType::empty;  // base: the linear type of the same form
  int dimension_ = 0, degree_ = 1;
  size_t nodes_ = 0;
  std::array<int, 3> orders_{1, 1, 1};
  std::vector<Vec3> at_;
  Vec3 center_{0, 0, 0};
  enum class Kind : uint8_t { linear, lattice, space } kind_ = Kind::linear;
  bool bernstein_ = false;
  std::vector<uint16_t> lattice_;  // place of each node in the element's lattice: three numbers a node
  std::vector<double> coefficients_;
  std::shared_ptr<const basis::Space> space_;
};

}  // namespace sg
