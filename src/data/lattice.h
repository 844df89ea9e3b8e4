// SPDX-License-Identifier: Apache-2.0
// LatticeView: the one way kernels see uniform, rectilinear and curvilinear grids.
#pragma once
#include <array>

#include "data/mesh.h"

namespace sg {

/// Positions of the points of an nx*ny*nz lattice: affine, separable or listed.
struct LatticeView {
  enum class Mode { affine, separable, listed };
  Mode mode = Mode::affine;
  std::array<size_t, 3> dims{1, 1, 1};
  Vec3 origin{0, 0, 0};          // affine: point (0,0,0); listed: added to xyz
  Vec3 step[3];                  // affine: from one point to the next along each axis
  const double* axis[3]{};       // separable: coordinates (owned by LatticeAxes)
  const float* xyz32 = nullptr;  // listed: packed positions, one of the two
  const double* xyz64 = nullptr;

  size_t points() const { return dims[0] * dims[1] * dims[2]; }
  size_t cells() const;
  /// Cells per axis: max(n-1, 1).
  std::array<size_t, 3> cell_dims() const;
  size_t id(size_t i, size_t j, size_t k) const { return i + dims[0] * (j + dims[1] * k); }

  Vec3 position(size_t i, size_t j, size_t k) const {
    switch (mode) {
      case Mode::affine: return origin + step[0] * double(i) + step[1] * double(j) + step[2] * double(k);
      case Mode::separable: return {axis[0][i], axis[1][j], axis[2][k]};
      case Mode::listed: break;
    }
    const size_t p = 3 * id(i, j, k);
    if (xyz32) return {origin.x + double(xyz32[p]), origin.y + double(xyz32[p + 1]), origin.z + double(xyz32[p + 2])};
    return {origin.x + xyz64[p], origin.y + xyz64[p + 1], origin.z + xyz64[p + 2]};
  }
};

/// A LatticeView and what it points to; keeps the arrays alive.
class Lattice {
 public:
  /// Throws an internal Error for a mesh that is not a lattice.
  explicit Lattice(const Mesh& mesh);
  const LatticeView& view() const { return view_; }

 private:
  LatticeView view_;
  std::vector<double> axes_[3];
  Array listed_;
};

/// Uniform, rectilinear or curvilinear?
bool is_lattice(const Mesh& mesh);
/// Between two points along an axis that has some; 0 where there is but one point.
double shortest_spacing(const UniformGrid& grid);
/// Points per axis of a lattice; {count,1,1} for other meshes.
std::array<size_t, 3> lattice_dims(const Mesh& mesh);

}  // namespace sg
