// SPDX-License-Identifier: Apache-2.0
// All zeros of a smooth function in a triangle or tetrahedron, from values only: for interpolants that are not polynomials.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "base/vec.h"

namespace sg {

/// As many components as variables (2 or 3; the others are 0). A simplex is left out when the control points of the quadratic through its
/// corners and the middles of its edges have one sign, grown by their distance from the linear interpolant; with the components as they
/// are or multiplied with the inverse of the linear gradient. It holds one zero at most when the quadratic bends by less than a part of
/// its own size (the gradient then stays invertible), and Newton's method finds it; else it is cut in 4 (8). Not thread-safe.
class SimplexZeros {
 public:
  using Function = std::function<bool(Vec3 x, Vec3& v)>;
  /// `polish` refines a nearby point to the zero itself; false where there is none.
  using Polish = std::function<bool(Vec3 start, Vec3& zero)>;
  SimplexZeros(int dimension, Function f, Polish polish) : dimension_(dimension), f_(std::move(f)), polish_(std::move(polish)) {}

  /// Appends the zeros in simplices of 3 or 4 corners (or within a millionth of them), each once, in the order of the simplices. `corners`:
  /// zeros that are known already, about which nothing is searched below 1/256 of the simplex. False when zeros are not isolated.
  bool solve(std::span<const Vec3> simplices, std::span<const Vec3> corners, std::vector<Vec3>& zeros);

 private:
  struct Piece {
    Vec3 at[4], v[4];
    int depth;
  };
  bool examine(const Piece& p, const Vec3* middle, std::vector<Vec3>& zeros, bool& split);
  void keep(const Piece& p, Vec3 start, double slack, std::vector<Vec3>& zeros);

  int dimension_;
  Function f_;
  Polish polish_;
  size_t first_ = 0;
  double size_ = 0;
  std::vector<Piece> stack_;
};

}  // namespace sg
