// SPDX-License-Identifier: Apache-2.0
// GridIndex: cells of a uniform or rectilinear grid, or of a patch of one, found by arithmetic.
#pragma once
#include <array>

#include "base/vec.h"
#include "data/cells/shape/cell_map.h"
#include "data/lattice.h"

namespace sg {

/// Works in grid coordinates q: numbers of points along the axes of an affine lattice, positions for a rectilinear one; along an axis of
/// one point always a distance.
class GridIndex {
 public:
  /// `view` is affine or separable; what it points to must live on.
  explicit GridIndex(const LatticeView& view);

  /// The smallest of the cells that hold x (solids: to 1e-9 of a cell; lattices with an axis of one point: within the distance `slack`) and
  /// for which `skip` is false; -1: none. `place` gets its reference coordinates.
  template <class Skip>
  int64_t find(Vec3 x, double slack, Skip&& skip, CellPlace& place) const {
    const Vec3 q = to_grid(x);
    const int64_t cell = find_grid(q, slack, skip, place);
    if (cell >= 0) place.nearest = any_flat_ ? position(cell, place) : x;
    return cell;
  }
  /// Point ids and multilinear weights of a place, in the order of CellReader (bit a of k steps along the a-th axis with cells); how many.
  int weights(int64_t cell, const CellPlace& place, int64_t ids[8], double out[8]) const;

  /// Axes at right angles: the nearest point is the clamped one.
  bool orthogonal() const { return orthogonal_; }
  Vec3 nearest(Vec3 x, int64_t& cell) const;

  struct Hit {
    double t = NAN;
    int64_t cell = -1;
    Vec3 normal{0, 0, 0};
  };
  /// First face (2D: cell) on the ray x + t d, t in [t0, t1]; cells as in find().
  Hit first_hit(Vec3 x, Vec3 d, double t0, double t1, double slack) const;

 private:
  Vec3 to_grid(Vec3 x) const {
    if (separable_) return {flat_[0] ? x.x - first_[0] : x.x, flat_[1] ? x.y - first_[1] : x.y, flat_[2] ? x.z - first_[2] : x.z};
    return direction_to_grid(x - origin_);
  }
  Vec3 direction_to_grid(Vec3 d) const { return separable_ ? d : Vec3(dot(rows_[0], d), dot(rows_[1], d), dot(rows_[2], d)); }
  Vec3 to_world(Vec3 q) const;
  Vec3 position(int64_t cell, const CellPlace& place) const;
  /// Cells along axis a whose closed interval holds q, ascending, and q in each as a number from 0 to 1 (or outside by the tolerance).
  int cells_of(int a, double q, double slack, size_t index[3], double r[3]) const;
  double plane(int a, size_t i) const { return axis_[a] ? axis_[a][i] : double(i); }
  template <class Skip>
  int64_t find_grid(Vec3 q, double slack, Skip&& skip, CellPlace& place) const {
    size_t i[3][3];
    double r[3][3];
    int n[3];
    for (int a = 0; a < 3; ++a)
      if ((n[a] = cells_of(a, q[a], slack, i[a], r[a])) == 0) return -1;
    for (int c = 0; c < n[2]; ++c)
      for (int b = 0; b < n[1]; ++b)
        for (int a = 0; a < n[0]; ++a) {
          const size_t cell = i[0][a] + cells_[0] * (i[1][b] + cells_[1] * i[2][c]);
          if (skip(cell)) continue;
          double all[3] = {r[0][a], r[1][b], r[2][c]};
          if (any_flat_ && !close(q, {i[0][a], i[1][b], i[2][c]}, all, slack)) continue;
          place = CellPlace{};
          for (int axis = 0, k = 0; axis < 3; ++axis)
            if (!flat_[axis]) place.rst[k++] = all[axis];
          return int64_t(cell);
        }
    return -1;
  }
  /// Whether a cell of points, lines or pixels is within `slack` of q. Clamps r to it.
  bool close(Vec3 q, const std::array<size_t, 3>& cell, double r[3], double slack) const;
  double width(int a, size_t i) const { return std::abs(axis_[a] ? axis_[a][i + 1] - axis_[a][i] : length(step_[a])); }
  Hit hit_plane(double t, int a, size_t plane_number, Vec3 o, Vec3 d, double slack) const;

  std::array<size_t, 3> points_, cells_;
  bool flat_[3], any_flat_ = false, separable_ = false, orthogonal_ = true;
  const double* axis_[3] = {nullptr, nullptr, nullptr};
  Vec3 origin_, step_[3], rows_[3];
  double first_[3] = {0, 0, 0};
};

}  // namespace sg
