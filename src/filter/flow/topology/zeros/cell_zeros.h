// SPDX-License-Identifier: Apache-2.0
// All zeros of a velocity inside one cell of any kind, of the interpolant that the cell's shape functions (or mean value coordinates) make.
#pragma once
#include <memory>
#include <vector>

#include "data/cells/shape/cell_map.h"
#include "filter/flow/flow_field.h"
#include "filter/flow/topology/zeros/bernstein_basis.h"
#include "filter/flow/topology/zeros/plane_frame.h"

namespace sg {

struct CellZero {
  static constexpr double on_border = 1e-6;  ///< zeros that near to the border may be another cell's too

  Vec3 rst;             ///< reference coordinates; polygons and polyhedra: unused
  Vec3 at;              ///< place
  Mat3 gradient;        ///< m[i][j] = dv_i/dx_j
  double size = 0;      ///< of the cell: diagonal of the box of its nodes
  double speed = 0;     ///< largest at the cell's points
  bool border = false;  ///< on the cell's border (to on_border), where other cells may find it too
  int64_t node = -1;    ///< the mesh point whose velocity is exactly zero, where the zero is one
};

/// Triangles, tetrahedra: solved; pixels and quads in a plane: a quadratic equation; the other cells with a reference map, curved and
/// rational ones too: BernsteinZeros of the interpolant, exact for polynomials (pyramids are polynomials once their apex is a face).
/// Strips: by triangles. Polygons and polyhedra: SimplexZeros of the mean value interpolant, between the middle and the sides. Not
/// thread-safe.
class CellZeros {
 public:
  /// `frame`: the plane of a mesh of 2D cells; null: solids only, others have none. Cells slower than `min_speed` at all points: none.
  CellZeros(const FlowField& flow, const PlaneFrame* frame, double min_speed = 0);
  ~CellZeros();

  enum class Result : uint8_t {
    none,      ///< no zero, hidden, or without values
    isolated,  ///< what was appended is all
    spread     ///< lines or areas of zeros: isolated ones next to them may be missing
  };
  Result find(size_t cell, std::vector<CellZero>& out);
  /// Points of exactly zero velocity that share an edge with another such point in some cell that was searched.
  std::vector<int64_t>& spread_points() { return spread_; }

 private:
  BernsteinBasis& basis_of(const CellShape& shape);
  Result find_open(bool some, std::vector<CellZero>& out);
  Result find_linear(std::vector<CellZero>& out);
  Result find_bilinear(std::vector<CellZero>& out);
  Result find_polynomial(const CellShape& shape, std::vector<CellZero>& out);
  Result find_strip(std::vector<CellZero>& out);
  Result find_sampled(std::vector<CellZero>& out);
  void fan_of_cell(Vec3 middle, std::vector<Vec3>& out);
  void add_sampled(Vec3 x, size_t before, std::vector<CellZero>& out);
  void add_corners(double size, std::vector<CellZero>& out);
  bool newton_from(Vec3 x, Vec3& found, Mat3& gradient);
  bool at_place(Vec3 x, Vec3& v);
  bool zero_edges(Result& result);
  bool zero_sides(Result& result);
  void add(Vec3 rst, double outside, std::vector<CellZero>& out);

  const FlowField& flow_;
  const PlaneFrame* frame_;
  double min_speed_;
  CellMap map_;
  std::vector<Vec3> v_, slopes_;  // velocities of the nodes
  std::vector<double> weights_;
  std::vector<uint8_t> zero_;  // of the nodes
  std::vector<int64_t> spread_;
  std::vector<std::array<Vec3, 2>> known_;  // edges of zeros, in the coordinates of the solver
  std::vector<Vec3> found_;
  std::vector<std::unique_ptr<BernsteinBasis>> bases_;
};

}  // namespace sg
