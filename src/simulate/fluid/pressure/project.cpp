// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/pressure/project.h"

#include <utility>
#include <vector>

#include "base/parallel.h"
#include "simulate/fluid/lattice_sums.h"

namespace sg::fluid {

namespace {

constexpr size_t flow_rows = 32;

}  // namespace

template <class T>
Projection<T>::Projection(const MacGrid& grid, Walls<T> walls) : grid_(grid), solver_(grid.cells, std::move(walls)) {}

template <class T>
void Projection<T>::set_air(std::vector<uint8_t> air) {
  air_ = air;
  solver_.set_air(std::move(air));
}

// What closed sides and solids that move push out of a row of cells.
template <class T>
void Projection<T>::add_solid_flow(size_t row, T* to) const {
  const auto& n = grid_.cells;
  const Walls<T>& w = walls();
  const size_t j = row % n[1], k = row / n[1], y = j + (n[1] + 1) * k;
  to[0] -= w.through[0], to[n[0] - 1] += w.through[1];
  const auto add = [&](bool there, T by) {
    for (size_t i = 0; there && by != 0 && i < n[0]; ++i) to[i] += by;
  };
  add(j == 0, -w.through[2]), add(j + 1 == n[1], w.through[3]), add(k == 0, -w.through[4]), add(k + 1 == n[2], w.through[5]);
  if (!w.move()) return;
  const auto flow = [&](size_t a, size_t face_row, size_t i) { return (1 - w.open[a].row(face_row)[i]) * w.solid[a].row(face_row)[i]; };
  for (size_t i = 0; i < n[0]; ++i) {  // faces of the sides have their own
    if (i > 0) to[i] -= flow(0, row, i);
    if (i + 1 < n[0]) to[i] += flow(0, row, i + 1);
    if (j > 0) to[i] -= flow(1, y, i);
    if (j + 1 < n[1]) to[i] += flow(1, y + 1, i);
    if (k > 0) to[i] -= flow(2, row, i);
    if (k + 1 < n[2]) to[i] += flow(2, row + n[1], i);
  }
}

template <class T>
void Projection<T>::divergence(const Faces<T>& u, Lattice<T>& out, const Context& context) const {
  const auto& n = grid_.cells;
  const Walls<T>& w = walls();
  const std::vector<T> ones(n[0] + 1, 1), zeros(n[0] + 1, 0);
  std::vector<T> along_x = ones;
  along_x.front() = w.sides[0] ? T(1) : T(0), along_x.back() = w.sides[1] ? T(1) : T(0);
  // The open shares of a row of faces across an axis.
  const auto shares = [&](size_t a, size_t row, size_t at) {
    if ((at == 0 && !w.sides[2 * a]) || (at == n[a] && !w.sides[2 * a + 1])) return zeros.data();
    return w.obstacles() ? w.open[a].row(row) : ones.data();
  };
  parallel_for(
      out.rows(), flow_rows,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) {
          const size_t j = row % n[1], k = row / n[1], y = j + (n[1] + 1) * k;
          const T *ux = u[0].row(row), *wx = w.obstacles() ? w.open[0].row(row) : along_x.data();
          const T *u0 = u[1].row(y), *u1 = u[1].row(y + 1), *w0 = shares(1, y, j), *w1 = shares(1, y + 1, j + 1);
          const T *d0 = u[2].row(row), *d1 = u[2].row(row + n[1]), *z0 = shares(2, row, k), *z1 = shares(2, row + n[1], k + 1);
          T* const to = out.row(row);
          for (size_t i = 0; i < n[0]; ++i)
            to[i] = (wx[i + 1] * ux[i + 1] - wx[i] * ux[i]) + (w1[i] * u1[i] - w0[i] * u0[i]) + (z1[i] * d1[i] - z0[i] * d0[i]);
          add_solid_flow(row, to);
        }
      },
      &context);
}

// u -= grad p across one axis; nothing flows through solid faces.
template <class T>
void Projection<T>::subtract_gradient(size_t a, const Lattice<T>& p, Lattice<T>& v, const Context& context) const {
  const Walls<T>& w = walls();
  const size_t n = grid_.cells[a];
  // Nothing flows through solid faces, but as they move; the closed sides have been seen to.
  const auto hold_solid = [&](size_t row, size_t place) {
    if (!w.obstacles() || (a > 0 && ((place == 0 && !w.sides[2 * a]) || (place == n && !w.sides[2 * a + 1])))) return;
    const T *const share = w.open[a].row(row), *const solid = w.move() ? w.solid[a].row(row) : nullptr;
    T* const to = v.row(row);
    const size_t first = a == 0 && !w.sides[0] ? 1 : 0, last = a == 0 && !w.sides[1] ? n : v.n[0];
    for (size_t i = first; i < last; ++i) to[i] = share[i] > 0 ? to[i] : solid ? solid[i] : T(0);
  };
  parallel_for(
      v.rows(), flow_rows,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) {
          const size_t j = row % v.n[1], k = row / v.n[1];
          T* const to = v.row(row);
          // At open sides p is 0 on the face itself, half a cell away.
          const auto at_side = [&](size_t side, T& face, T inside) {
            face = w.sides[2 * a + side] ? face + (side ? 2 : -2) * inside : w.through[2 * a + side];
          };
          if (a == 0) {
            const T* const here = p.row(row);
            for (size_t i = 1; i < n; ++i) to[i] -= here[i] - here[i - 1];
            at_side(0, to[0], here[0]), at_side(1, to[n], here[n - 1]);
          } else {
            const size_t f = a == 1 ? j : k, stride = a == 1 ? 1 : grid_.cells[1];
            const size_t row_of_cells = j + grid_.cells[1] * k;  // above the face
            if (f == 0 || f == n) {
              const T* const inside = p.row(f == 0 ? row_of_cells : row_of_cells - stride);
              for (size_t i = 0; i < v.n[0]; ++i) at_side(f == n, to[i], inside[i]);
            } else {
              const T *const above = p.row(row_of_cells), *const below = p.row(row_of_cells - stride);
              for (size_t i = 0; i < v.n[0]; ++i) to[i] -= above[i] - below[i];
            }
          }
          hold_solid(row, a == 1 ? j : k);
        }
      },
      &context);
}

template <class T>
SolveReport Projection<T>::apply(Faces<T>& u, Lattice<T>& p, double tolerance, Spare<T> spare, const Context& context) {
  Lattice<T>& b = shaped(spare[4], grid_.cells);
  divergence(u, b, context);
  parallel_for(
      b.values.size(), values_at_once,
      [&, bv = b.values.data()](size_t begin, size_t end) {
        if (air_.empty())
          for (size_t i = begin; i < end; ++i) bv[i] = -bv[i];
        else
          for (size_t i = begin; i < end; ++i) bv[i] = air_[i] ? T(0) : -bv[i];
      },
      &context);
  for (size_t i = 0; i < air_.size(); ++i)
    if (air_[i]) p.values[i] = 0;
  const SolveReport report = solver_.solve(b, p, tolerance, spare.first(4), context);
  for (size_t a = 0; a < size_t(grid_.axes()); ++a) subtract_gradient(a, p, u[a], context);
  return report;
}

template class Projection<float>;
template class Projection<double>;

}  // namespace sg::fluid
