// SPDX-License-Identifier: Apache-2.0
// LatticeFrame: a lattice without its one-point axes, and second-order derivatives on it.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "data/lattice.h"

namespace sg {

/// d/di at one place of an axis: the sum of w[k] * f[p + o[k]]. Interior places are central, ends are one-sided, both of
/// second order; an axis of two points has first order, one of one point gives 0.
struct AxisStencil {
  ptrdiff_t o[3]{};  ///< elements from the point itself
  double w[3]{};
  double d[3]{};  ///< distance along the axis, in the unit of the derivative
};

/// The axes of a lattice that have more than one point, in order, then those with one. Dropping one-point axes leaves the
/// point numbers as they are, so a kernel for x-y grids also serves x-z and y-z grids. Keeps nothing alive but itself.
struct LatticeFrame {
  explicit LatticeFrame(const LatticeView& view);

  std::array<size_t, 3> dims{1, 1, 1};
  int axes = 0;                        ///< axes with more than one point
  std::array<int, 3> source{0, 1, 2};  ///< axis of the lattice
  std::array<ptrdiff_t, 3> stride{1, 1, 1};
  std::vector<AxisStencil> stencil[3];  ///< separable: of the coordinate; otherwise of the index
  LatticeView view;
  Mat3 to_world;  ///< affine and separable: gradient = to_world * (derivatives along the frame's axes)

  size_t id(size_t i, size_t j, size_t k) const { return i + dims[0] * (j + dims[1] * k); }

  Vec3 position(size_t i, size_t j, size_t k) const {
    if (axes == 3) return view.position(i, j, k);
    size_t at[3] = {0, 0, 0};
    at[source[0]] = i, at[source[1]] = j, at[source[2]] = k;
    return view.position(at[0], at[1], at[2]);
  }
  /// Position of listed point p.
  Vec3 listed(size_t p) const {
    if (view.xyz32)
      return {view.origin.x + double(view.xyz32[3 * p]), view.origin.y + double(view.xyz32[3 * p + 1]),
              view.origin.z + double(view.xyz32[3 * p + 2])};
    return {view.origin.x + view.xyz64[3 * p], view.origin.y + view.xyz64[3 * p + 1], view.origin.z + view.xyz64[3 * p + 2]};
  }

  /// Listed: the matrix that turns derivatives along the axes into a gradient at point p = id(i,j,k); axes that are missing or
  /// folded flat contribute nothing.
  Mat3 metric(size_t p, const size_t at[3]) const;

  /// False when the axes make a left-handed system, so that surfaces must be wound the other way round.
  bool right_handed() const;
};

/// Derivative along one axis next to missing values (NaN): the neighbours that are there give a one-sided difference of
/// first order; 0 when there are none.
template <class Value>
double careful_derivative(const AxisStencil& s, size_t p, Value&& f) {
  const double here = f(p);
  double sum = 0, weight = 0;
  for (int k = 0; k < 3; ++k) {
    if (s.o[k] == 0 || s.w[k] == 0) continue;
    const double there = f(size_t(ptrdiff_t(p) + s.o[k]));
    if (!std::isfinite(there)) continue;
    sum += s.w[k] * (there - here);
    weight += s.w[k] * s.d[k];  // exact for linear functions whichever neighbours are left
  }
  return weight != 0 ? sum / weight : 0.0;
}

}  // namespace sg
