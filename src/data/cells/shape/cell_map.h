// SPDX-License-Identifier: Apache-2.0
// CellMap: the map from reference coordinates to space of one open cell, its inverse, and interpolation weights, for every type.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "data/cells/cell_reader.h"
#include "data/cells/shape/cell_shape.h"

namespace sg {

/// Where a point lies in a cell.
struct CellPlace {
  Vec3 rst{0, 0, 0};      ///< reference coordinates; polygons and polyhedra: unused; strips, poly-lines: z is the piece
  double outside = 0;     ///< <= 0 inside, else how far out in reference units (polygons, polyhedra: in cell sizes)
  Vec3 nearest{0, 0, 0};  ///< nearest point of the cell found (the point itself when inside a solid; see locate and nearest)
  double distance2 = 0;   ///< squared distance to it
};

/// A cell ready for geometry. Not thread-safe: one per thread.
class CellMap {
 public:
  explicit CellMap(DatasetPtr dataset) : reader_(std::move(dataset)) {}
  /// Throws Error(data) for a cell that has no known functions: a pyramid of order 3 and above, a Lagrange or Bezier cell whose
  /// nodes fit no order of 1..10.
  void open(size_t cell);
  const CellReader& reader() const { return reader_; }
  int dimension() const { return reader_.dimension(); }

  /// x(r,s,t). Types with a reference map only.
  Vec3 position(Vec3 rst) const;
  /// Columns dx/dr, dx/ds, dx/dt (unused columns 0).
  Mat3 jacobian(Vec3 rst) const;
  /// Inverse map: Newton with bracketing by subdivision where Newton leaves or stalls (distorted cells). False when x lies further
  /// outside than `tolerance` (reference units); `place` then holds the best found. Cells below dimension 3: the nearest point on the
  /// curve or surface, inside when its distance is at most tolerance times the cell's size. Fast where x is in no solid: then
  /// `nearest` is the image of the clamped reference place, a guess; polyhedra, curves and surfaces give the true one.
  bool locate(Vec3 x, CellPlace& place, double tolerance = 1e-9);
  /// The nearest point of the cell: x itself inside a solid, else the nearest of its faces (curved ones by iteration).
  void nearest(Vec3 x, CellPlace& place);
  /// Of a cell that is known not to hold x: the nearest point and its distance alone.
  void nearest_outside(Vec3 x, CellPlace& place);
  /// Interpolation weights of ids() at a located place: shape functions (rational where weighted); polygons by mean value
  /// coordinates in their plane (Floater 2003); polyhedra by mean value coordinates of their triangulated faces (Ju et al. 2005);
  /// strips and poly-lines by their triangle or piece.
  void weights(const CellPlace& place, std::span<double> out);
  /// Length, area or volume; signed for solids with a reference map (negative = turned inside out); polyhedra by their faces.
  double measure();
  /// Integral of each node's weight over the cell: sum_k w_k f_k integrates a field. Sums to |measure()|.
  void integration_weights(std::span<double> out);
  /// Gradient of a field given by its node values at a place: J^-T dN f; least squares fit of the nodes for polygons and polyhedra.
  /// Cells below dimension 3: the tangential gradient.
  Vec3 gradient(const CellPlace& place, std::span<const double> node_values);
  /// The same as one vector per node: gradient = sum_k g_k f_k.
  void gradient_weights(const CellPlace& place, std::span<Vec3> out);
  Vec3 center() const;

 private:
  struct Geometry;
  double size() const;
  bool locate_tetra(Vec3 x, CellPlace& place, double tolerance) const;
  bool locate_box(Vec3 x, CellPlace& place, double tolerance, bool& affine) const;
  bool locate_solid(Vec3 x, CellPlace& place, double tolerance);
  bool locate_flat(Vec3 x, CellPlace& place, double tolerance);
  bool locate_pieces(Vec3 x, CellPlace& place, double tolerance);
  bool locate_polyhedron(Vec3 x, CellPlace& place, double tolerance);
  void pieces_weights(const CellPlace& place, std::span<double> out);
  void nearest_of_faces(Vec3 x, CellPlace& place);
  double integrate(double* weights);
  double integrate_pieces(double* weights);
  void fitted_gradient(Vec3 x, std::span<Vec3> out) const;
  /// Triangles of polygons, strips and polyhedra, as indices into ids(), made on first use.
  const std::vector<uint32_t>& triangles();

  CellReader reader_;
  const CellShape* shape_ = nullptr;
  std::array<int, 3> orders_{0, 0, 0};
  std::vector<double> n_;
  std::vector<Vec3> dn_;
  bool triangles_known_ = false;
  std::vector<uint32_t> triangles_, ring_;
  std::vector<Vec3> ring_at_;
  std::vector<double> ring_weights_;
  struct FixedShape {
    bool known = false;
    const CellShape* shape = nullptr;
  };
  std::array<FixedShape, 256> fixed_shapes_{};  // of the types whose name says how many nodes they have
};

}  // namespace sg
