// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/advection/place_velocity.h"

namespace sg::fluid {

template <class T>
void place_velocities(const MacGrid& g, const Faces<T>& u, int axis, size_t row, T* const out[3]) {
  const auto n = axis < 0 ? g.cells : g.faces(axis);
  const size_t at[3] = {0, row % n[1], row / n[1]};
  for (int a = 0; a < 3; ++a) {
    const Lattice<T>& l = u[size_t(a)];
    T* const to = out[a];
    if (a >= g.axes()) {
      std::fill(to, to + n[0], T(0));
      continue;
    }
    // Indices of the faces below and above along each axis: across its own axis both of a cell; along that of the lattice those on either
    // side of the place.
    size_t below[3], above[3];
    for (int b = 0; b < 3; ++b) {
      below[b] = above[b] = at[b];
      if (a == axis) continue;
      if (b == a) above[b] = at[b] + 1;
      else if (b == axis) below[b] = at[b] > 0 ? at[b] - 1 : 0, above[b] = std::min(at[b], g.cells[size_t(b)] - 1);
    }
    // Of the four faces two pairs are one where the place lies on faces, or between two alone.
    const T* rows[4];
    const auto line = [&](size_t j, size_t k) { return l.row(j + l.n[1] * k); };
    const bool pair_x = a != axis && (a == 0 || axis == 0), pair_y = below[1] != above[1];
    if (pair_x) {
      rows[0] = line(below[1], below[2]), rows[2] = line(above[1], above[2]);
      rows[1] = rows[0] + 1, rows[3] = rows[2] + 1;
    } else if (pair_y) {
      rows[0] = line(below[1], below[2]), rows[1] = line(above[1], below[2]);
      rows[2] = line(below[1], above[2]), rows[3] = line(above[1], above[2]);
    } else {
      rows[0] = rows[1] = line(below[1], below[2]), rows[2] = rows[3] = line(below[1], above[2]);
    }
    const auto mean = [&](size_t i) { return ((rows[0][i] + rows[1][i]) + (rows[2][i] + rows[3][i])) / 4; };
    if (a != axis && axis == 0) {  // faces on either side of a place along x; the outermost have one alone
      const size_t last = n[0] - 1;
      for (size_t i = 1; i < last; ++i) to[i] = mean(i - 1);
      to[0] = (rows[0][0] + rows[2][0]) / 2, to[last] = (rows[0][last - 1] + rows[2][last - 1]) / 2;
    } else {
      for (size_t i = 0; i < n[0]; ++i) to[i] = mean(i);
    }
  }
}

template void place_velocities(const MacGrid&, const Faces<float>&, int, size_t, float* const[3]);
template void place_velocities(const MacGrid&, const Faces<double>&, int, size_t, double* const[3]);

}  // namespace sg::fluid
