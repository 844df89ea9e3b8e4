// SPDX-License-Identifier: Apache-2.0
// The staggered grid (marker and cell: Harlow, Welch 1965): what a cell holds lies at its middle, each component of the velocity in the
// middle of the faces across its axis, so that the flow through every face of a cell is known.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "base/huge_allocator.h"
#include "base/vec.h"

namespace sg::fluid {

/// Numbers on nx x ny x nz places, x fastest.
template <class T>
struct Lattice {
  std::array<size_t, 3> n{};
  Plane<T> values;

  Lattice() = default;
  explicit Lattice(std::array<size_t, 3> places, T value = 0) : n(places) { values.assign(n[0] * n[1] * n[2], value); }
  size_t rows() const { return n[1] * n[2]; }
  T* row(size_t r) { return values.data() + r * n[0]; }
  const T* row(size_t r) const { return values.data() + r * n[0]; }
  T& operator()(size_t i, size_t j, size_t k) { return values[i + n[0] * (j + n[1] * k)]; }
  T operator()(size_t i, size_t j, size_t k) const { return values[i + n[0] * (j + n[1] * k)]; }
};

/// Lattices whose numbers nobody needs any more.
template <class T>
using Spare = std::span<Lattice<T>>;
/// The lattice, with so many places; its numbers are any.
template <class T>
Lattice<T>& shaped(Lattice<T>& l, const std::array<size_t, 3>& n) {
  l.n = n, l.values.resize(n[0] * n[1] * n[2]);
  return l;
}

/// Cubes of side h from `origin` on. With one cell along z the flow is flat: nothing moves along z.
struct MacGrid {
  std::array<size_t, 3> cells{1, 1, 1};
  double h = 1;
  Vec3 origin;

  double count() const { return double(cells[0]) * double(cells[1]) * double(cells[2]); }
  bool flat() const { return cells[2] == 1; }
  int axes() const { return flat() ? 2 : 3; }
  std::array<size_t, 3> faces(int axis) const {
    auto n = cells;
    ++n[size_t(axis)];
    return n;
  }
  /// Places of a component of the velocity, or (axis < 0) of the cells, lie at (i, j, k) + shift in units of h.
  static constexpr std::array<double, 3> shift(int axis) { return {axis == 0 ? 0 : 0.5, axis == 1 ? 0 : 0.5, axis == 2 ? 0 : 0.5}; }
};

/// One number a face, for each axis.
template <class T>
using Faces = std::array<Lattice<T>, 3>;
template <class T>
Faces<T> make_faces(const MacGrid& g, T value = 0) {
  return {Lattice<T>(g.faces(0), value), Lattice<T>(g.faces(1), value), Lattice<T>(g.faces(2), value)};
}

}  // namespace sg::fluid
