// SPDX-License-Identifier: Apache-2.0
// The staggered grid (marker and cell: Harlow, Welch 1965): what a cell holds lies at its middle, each component of the velocity in the
// middle of the faces across its axis, so that the flow through every face of a cell is known.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>

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

/// Cubes of side h from `origin` on. With one cell along z the flow is flat: nothing moves along z.
struct MacGrid {
  std::array<size_t, 3> cells{1, 1, 1};
  double h = 1;
  Vec3 origin;

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

/// A place between the numbers of a lattice, held at its border.
template <class T>
struct Spot {
  size_t at = 0;                  ///< of the corner with the smallest indices
  size_t dx = 0, dy = 0, dz = 0;  ///< to its neighbours; 0 along axes of one place
  T x = 0, y = 0, z = 0;          ///< shares of the neighbours

  Spot(const std::array<size_t, 3>& n, T px, T py, T pz) {
    const auto split = [](size_t count, T p, T& share) {
      if (count < 2) return size_t(0);
      p = std::min(std::max(p, T(0)), T(count - 1));
      const size_t i = std::min(size_t(p), count - 2);
      share = p - T(i);
      return i;
    };
    const size_t i = split(n[0], px, x), j = split(n[1], py, y), k = split(n[2], pz, z);
    at = i + n[0] * (j + n[1] * k);
    dx = n[0] > 1 ? 1 : 0, dy = n[1] > 1 ? n[0] : 0, dz = n[2] > 1 ? n[0] * n[1] : 0;
  }
  T sample(const T* v) const {
    v += at;
    const auto along = [&](const T* a) { return a[0] + x * (a[dx] - a[0]); };
    const T a = along(v), b = along(v + dy);
    const T low = a + y * (b - a);
    if (dz == 0) return low;
    const T c = along(v + dz), d = along(v + dy + dz);
    const T high = c + y * (d - c);
    return low + z * (high - low);
  }
  /// The least and the largest of the numbers that sample() mixes.
  std::array<T, 2> bounds(const T* v) const {
    v += at;
    T lo = v[0], hi = v[0];
    for (const size_t d : {dx, dy, dx + dy, dz, dx + dz, dy + dz, dx + dy + dz}) lo = std::min(lo, v[d]), hi = std::max(hi, v[d]);
    return {lo, hi};
  }
};

}  // namespace sg::fluid
