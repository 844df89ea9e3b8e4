// SPDX-License-Identifier: Apache-2.0
// The second differences of a room, place by place.
#pragma once
#include <vector>

#include "base/parallel.h"
#include "simulate/pde/room.h"

namespace sg::pde {

constexpr size_t rows_at_once = 32;

/// Calls f(place, neighbours, diagonal): the sums, over the axes, of x of the neighbours / h^2 and of 1 / h^2 for each neighbour, so that
/// the Laplacian is neighbours - diagonal x. Walls count as neighbours whose value is 0 (SideValues adds what they hold); insulated sides
/// have none. Step 1: of all places; Step 2: of one colour of the chessboard, of which f may change x.
template <size_t Step, class F>
void each_place(const std::array<Axis, 3>& axes, const Values& x, size_t color, const Context& context, F&& f) {
  const size_t nx = axes[0].n, ny = axes[1].n;
  const std::vector<double> zeros(nx);
  const double cx = axes[0].coupling();
  const bool round = !axes[0].flat() && axes[0].lo.kind == SideKind::periodic;
  const double first_links = axes[0].flat() || axes[0].lo.kind == SideKind::insulated ? 0 : 1,
               last_links = axes[0].flat() || axes[0].hi.kind == SideKind::insulated ? 0 : 1;
  parallel_for(
      x.rows(), rows_at_once,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) {
          const double* const here = x.row(row);
          const double* beside[4];
          double coupling[2], diagonal = 0;
          for (size_t a = 1; a < 3; ++a) {
            const Axis& axis = axes[a];
            const size_t stride = a == 1 ? 1 : ny, at = a == 1 ? row % ny : row / ny;
            const double c = coupling[a - 1] = axis.coupling();
            const double *&below = beside[2 * a - 2], *&above = beside[2 * a - 1];
            const bool periodic = axis.lo.kind == SideKind::periodic;
            below = above = zeros.data();
            if (axis.flat()) continue;
            if (at > 0) below = x.row(row - stride);
            else if (periodic) below = x.row(row + (axis.n - 1) * stride);
            if (at + 1 < axis.n) above = x.row(row + stride);
            else if (periodic) above = x.row(row - (axis.n - 1) * stride);
            if (at > 0 || axis.lo.kind != SideKind::insulated) diagonal += c;
            if (at + 1 < axis.n || axis.hi.kind != SideKind::insulated) diagonal += c;
          }
          const auto put = [&](size_t i, double west, double east, double links) {
            f(i + row * nx, cx * (west + east) + coupling[0] * (beside[0][i] + beside[1][i]) + coupling[1] * (beside[2][i] + beside[3][i]),
              diagonal + cx * links);
          };
          const size_t from = Step == 1 ? 0 : (color + row % ny + row / ny) % 2;
          const auto edge = [&](size_t i) {
            const bool low = i == 0, high = i + 1 == nx;
            put(i,
                !low    ? here[i - 1]
                : round ? here[nx - 1]
                        : 0,
                !high   ? here[i + 1]
                : round ? here[0]
                        : 0,
                (low ? first_links : 1) + (high ? last_links : 1));
          };
          size_t i = from;
          if (i == 0) edge(0), i += Step;
          for (; i + 1 < nx; i += Step) put(i, here[i - 1], here[i + 1], 2);
          if (i < nx) edge(i);
        }
      },
      &context);
}

}  // namespace sg::pde
