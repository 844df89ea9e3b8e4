// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/project.h"

#include <utility>

#include "base/parallel.h"

namespace sg::fluid {

namespace {

constexpr size_t flow_rows = 32;

template <class T>
Faces<T> without_closed_sides(const MacGrid& g, Faces<T> open, const OpenSides& sides) {
  for (size_t a = 0; a < 3; ++a)
    for (size_t side = 0; side < 2; ++side) {
      if (sides[2 * a + side] && int(a) < g.axes()) continue;
      std::array<size_t, 3> lo{0, 0, 0}, hi = open[a].n;
      lo[a] = side ? open[a].n[a] - 1 : 0, hi[a] = lo[a] + 1;
      for (size_t k = lo[2]; k < hi[2]; ++k)
        for (size_t j = lo[1]; j < hi[1]; ++j)
          for (size_t i = lo[0]; i < hi[0]; ++i) open[a](i, j, k) = 0;
    }
  return open;
}

}  // namespace

template <class T>
Projection<T>::Projection(const MacGrid& grid, Faces<T> open, const OpenSides& sides)
    : grid_(grid),
      open_(without_closed_sides(grid, std::move(open), sides)),
      sides_(sides),
      solver_(grid.cells, open_, sides),
      b_(grid.cells) {}

template <class T>
void Projection<T>::divergence(const Faces<T>& u, Lattice<T>& out, const Context& context) const {
  const auto& n = grid_.cells;
  parallel_for(
      out.rows(), flow_rows,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) {
          const size_t k = row / n[1], y = row % n[1] + (n[1] + 1) * k;
          const T *ux = u[0].row(row), *wx = open_[0].row(row), *u0 = u[1].row(y), *u1 = u[1].row(y + 1), *w0 = open_[1].row(y),
                  *w1 = open_[1].row(y + 1), *d0 = u[2].row(row), *d1 = u[2].row(row + n[1]), *z0 = open_[2].row(row),
                  *z1 = open_[2].row(row + n[1]);
          T* const to = out.row(row);
          for (size_t i = 0; i < n[0]; ++i)
            to[i] = wx[i + 1] * ux[i + 1] - wx[i] * ux[i] + w1[i] * u1[i] - w0[i] * u0[i] + z1[i] * d1[i] - z0[i] * d0[i];
        }
      },
      &context);
}

template <class T>
SolveReport Projection<T>::apply(Faces<T>& u, Lattice<T>& p, double tolerance, const Context& context) {
  divergence(u, b_, context);
  for (T& b : b_.values) b = -b;
  const SolveReport report = solver_.solve(b_, p, tolerance, context);
  for (size_t a = 0; a < size_t(grid_.axes()); ++a) {
    Lattice<T>& v = u[a];
    const size_t n = grid_.cells[a], stride = a == 0 ? 1 : a == 1 ? grid_.cells[0] : grid_.cells[0] * grid_.cells[1];
    parallel_for(
        v.rows(), flow_rows,
        [&](size_t begin, size_t end) {
          for (size_t row = begin; row < end; ++row)
            for (size_t i = 0; i < v.n[0]; ++i) {
              const std::array<size_t, 3> at{i, row % v.n[1], row / v.n[1]};
              const size_t face = i + row * v.n[0], f = at[a];
              if (!(open_[a].values[face] > 0)) {
                v.values[face] = 0;
                continue;
              }
              // Of the cell behind the face; beyond open sides p is 0 on the face itself, half a cell away.
              const size_t cell = at[0] + grid_.cells[0] * (at[1] + grid_.cells[1] * at[2]);
              if (f == 0) v.values[face] -= 2 * p.values[cell];
              else if (f == n) v.values[face] += 2 * p.values[cell - stride];
              else v.values[face] -= p.values[cell] - p.values[cell - stride];
            }
        },
        &context);
  }
  return report;
}

template class Projection<float>;
template class Projection<double>;

}  // namespace sg::fluid
