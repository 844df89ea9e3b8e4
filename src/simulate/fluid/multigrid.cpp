// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/multigrid.h"

#include <utility>

#include "base/parallel.h"

namespace sg::fluid {

namespace {

constexpr size_t row_grain = 32;
constexpr size_t coarsest = 64;  // cells that sweeps alone solve
constexpr int coarsest_sweeps = 16;

// The five rows about row (j, k) of cells and the open shares of its faces. Rows outside the box hold zeros.
template <class T>
struct Rows {
  const T *here, *south, *north, *below, *above;
  const T *wx, *wy0, *wy1, *wz0, *wz1;

  Rows(const std::array<size_t, 3>& n, const Faces<T>& open, const Lattice<T>& x, const T* zeros, size_t row) {
    const size_t j = row % n[1], k = row / n[1];
    here = x.row(row);
    south = j > 0 ? here - n[0] : zeros, north = j + 1 < n[1] ? here + n[0] : zeros;
    below = k > 0 ? here - n[0] * n[1] : zeros, above = k + 1 < n[2] ? here + n[0] * n[1] : zeros;
    wx = open[0].row(row);
    wy0 = open[1].row(j + (n[1] + 1) * k), wy1 = wy0 + n[0];
    wz0 = open[2].row(row), wz1 = wz0 + n[0] * n[1];
  }
  // Sums over the faces of cell i, of c w p of the neighbours and of c w.
  void sums(const std::array<T, 3>& c, size_t i, T west, T east, T& neighbours, T& diagonal) const {
    neighbours = c[0] * (wx[i] * west + wx[i + 1] * east) + c[1] * (wy0[i] * south[i] + wy1[i] * north[i]) +
                 c[2] * (wz0[i] * below[i] + wz1[i] * above[i]);
    diagonal = c[0] * (wx[i] + wx[i + 1]) + c[1] * (wy0[i] + wy1[i]) + c[2] * (wz0[i] + wz1[i]);
  }
};

// Calls f(cell, neighbours, diagonal) with the sums of Rows for all cells (Step 1) or those of one colour of the chessboard (Step 2).
template <size_t Step, class T, class Level, class F>
void each_cell(const Level& l, const Lattice<T>& x, size_t color, const Context& context, F&& f) {
  const std::vector<T> zeros(l.n[0]);
  parallel_for(
      x.rows(), row_grain,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) {
          const Rows<T> rows(l.n, l.open, x, zeros.data(), row);
          const size_t first = Step == 1 ? 0 : (color + row % l.n[1] + row / l.n[1]) % 2;
          for (size_t i = first; i < l.n[0]; i += Step) {
            T neighbours, diagonal;
            rows.sums(l.coupling, i, i > 0 ? rows.here[i - 1] : T(0), i + 1 < l.n[0] ? rows.here[i + 1] : T(0), neighbours, diagonal);
            f(i + row * l.n[0], neighbours, diagonal);
          }
        }
      },
      &context);
}

// The mean of the fine faces that make up each coarse one; those that are missing beyond an odd border count as solid.
template <class T>
Lattice<T> coarse_faces(const Lattice<T>& fine, int axis, const std::array<size_t, 3>& cells, const std::array<size_t, 3>& coarse_cells,
                        const std::array<bool, 3>& halved) {
  auto n = coarse_cells;
  ++n[size_t(axis)];
  Lattice<T> out(n);
  for (size_t k = 0; k < n[2]; ++k)
    for (size_t j = 0; j < n[1]; ++j)
      for (size_t i = 0; i < n[0]; ++i) {
        const std::array<size_t, 3> at{i, j, k};
        std::array<size_t, 3> lo, hi;
        T parts = 1;
        for (size_t a = 0; a < 3; ++a) {
          lo[a] = halved[a] ? 2 * at[a] : at[a], hi[a] = lo[a] + 1;
          if (a == size_t(axis)) lo[a] = std::min(lo[a], cells[a]), hi[a] = lo[a] + 1;
          else if (halved[a]) hi[a] = std::min(lo[a] + 2, cells[a]), parts *= 2;
        }
        T sum = 0;
        for (size_t z = lo[2]; z < hi[2]; ++z)
          for (size_t y = lo[1]; y < hi[1]; ++y)
            for (size_t x = lo[0]; x < hi[0]; ++x) sum += fine(x, y, z);
        out(i, j, k) = sum / parts;
      }
  return out;
}

}  // namespace

template <class T>
Multigrid<T>::Multigrid(std::array<size_t, 3> cells, Faces<T> open, const OpenSides& sides) {
  std::array<double, 3> h{1, 1, 1};
  levels_.push_back({cells, {1, 1, 1}, std::move(open), {}, {}, {}, {}});
  for (size_t a = 0; a < 3; ++a)
    for (size_t side = 0; side < 2; ++side) {  // half the distance to the border
      Lattice<T>& f = levels_[0].open[a];
      std::array<size_t, 3> lo{0, 0, 0}, hi = f.n;
      lo[a] = side ? f.n[a] - 1 : 0, hi[a] = lo[a] + 1;
      for (size_t k = lo[2]; k < hi[2]; ++k)
        for (size_t j = lo[1]; j < hi[1]; ++j)
          for (size_t i = lo[0]; i < hi[0]; ++i) f(i, j, k) *= sides[2 * a + side] ? T(2) : T(0);
    }
  for (;;) {
    Level& fine = levels_.back();
    fine.r = Lattice<T>(fine.n);
    std::array<bool, 3> halved{};
    std::array<size_t, 3> n = fine.n;
    for (size_t a = 0; a < 3; ++a) halved[a] = n[a] > 2, n[a] = halved[a] ? (n[a] + 1) / 2 : n[a];
    if (fine.n[0] * fine.n[1] * fine.n[2] <= coarsest || n == fine.n) break;
    Level next;
    next.n = n;
    for (size_t a = 0; a < 3; ++a) {
      h[a] *= halved[a] ? 2 : 1;
      next.open[a] = coarse_faces(fine.open[a], int(a), fine.n, n, halved);
      // A fine place takes 3/4 of the coarse one in which it lies and 1/4 of the next; at a wall all of the first, and between 0 at an
      // open border and it a half.
      fine.coarse[a].resize(n[a]);
      const auto take_part = [&](size_t coarse, size_t place, T weight) {
        Stencil& s = fine.coarse[a][coarse];
        if (s.count == 0) s.first = int(place);
        s.weight[int(place) - s.first] += weight, s.count = int(place) - s.first + 1;
      };
      for (size_t i = 0; i < fine.n[a]; ++i) {
        if (!halved[a]) {
          take_part(i, i, 1);
          continue;
        }
        const size_t own = i / 2;
        const bool up = i % 2 == 1, outside = up ? own + 1 >= n[a] : own == 0;
        take_part(own, i, outside ? (sides[2 * a + (up ? 1 : 0)] ? T(0.5) : T(1)) : T(0.75));
        if (!outside) take_part(up ? own + 1 : own - 1, i, T(0.25));
      }
    }
    next.coupling = {T(h[1] * h[2] / h[0]), T(h[0] * h[2] / h[1]), T(h[0] * h[1] / h[2])};
    next.x = next.b = Lattice<T>(n);
    levels_.push_back(std::move(next));
  }
}

template <class T>
void Multigrid<T>::apply(const Lattice<T>& x, Lattice<T>& out, const Context& context) const {
  T* const to = out.values.data();
  const T* const p = x.values.data();
  each_cell<1>(levels_.front(), x, 0, context, [=](size_t cell, T neighbours, T diagonal) { to[cell] = diagonal * p[cell] - neighbours; });
}

template <class T>
void Multigrid<T>::residual(const Level& l, const Lattice<T>& b, const Lattice<T>& x, Lattice<T>& r, const Context& context) const {
  T* const to = r.values.data();
  const T *const from = b.values.data(), *const p = x.values.data();
  each_cell<1>(l, x, 0, context, [=](size_t cell, T neighbours, T diagonal) {  // dry cells take no part
    to[cell] = diagonal > 0 ? from[cell] - (diagonal * p[cell] - neighbours) : T(0);
  });
}

template <class T>
void Multigrid<T>::smooth(const Level& l, const Lattice<T>& b, Lattice<T>& x, int color, const Context& context) const {
  T* const to = x.values.data();
  const T* const from = b.values.data();
  each_cell<2>(l, x, size_t(color), context,
               [=](size_t cell, T neighbours, T diagonal) { to[cell] = diagonal > 0 ? (from[cell] + neighbours) / diagonal : T(0); });
}

template <class T>
void Multigrid<T>::restrict_to(const Level& fine, const Lattice<T>& r, Lattice<T>& b, const Context& context) {
  parallel_for(
      b.rows(), row_grain,
      [&](size_t begin, size_t end) {
        std::vector<T> sum(fine.n[0]);
        for (size_t row = begin; row < end; ++row) {
          const Stencil &y = fine.coarse[1][row % b.n[1]], &z = fine.coarse[2][row / b.n[1]];
          std::fill(sum.begin(), sum.end(), T(0));
          for (int k = 0; k < z.count; ++k)
            for (int j = 0; j < y.count; ++j) {
              const T weight = z.weight[k] * y.weight[j];
              const T* const from = r.row(size_t(y.first + j) + fine.n[1] * size_t(z.first + k));
              for (size_t i = 0; i < fine.n[0]; ++i) sum[i] += weight * from[i];
            }
          T* const to = b.row(row);
          for (size_t i = 0; i < b.n[0]; ++i) {
            const Stencil& s = fine.coarse[0][i];
            T v = 0;
            for (int a = 0; a < s.count; ++a) v += s.weight[a] * sum[size_t(s.first + a)];
            to[i] = v;
          }
        }
      },
      &context);
}

template <class T>
void Multigrid<T>::prolong(const Level& fine, const Lattice<T>& coarse, Lattice<T>& x, const Context& context) {
  // Coarse rows that each fine row takes part in, and with what weight: at most two along y and z.
  const auto gather = [](const std::vector<Stencil>& stencils, size_t place, size_t from[2], T weight[2]) {
    int found = 0;
    const size_t around = stencils.size() > 1 ? place / 2 : 0;
    for (size_t c = around > 0 ? around - 1 : 0; c < stencils.size() && found < 2; ++c) {
      const int at = int(place) - stencils[c].first;
      if (at >= 0 && at < stencils[c].count && stencils[c].weight[at] != 0) from[found] = c, weight[found++] = stencils[c].weight[at];
      if (int(place) < stencils[c].first) break;
    }
    return found;
  };
  parallel_for(
      x.rows(), row_grain,
      [&](size_t begin, size_t end) {
        std::vector<T> sum(coarse.n[0]);
        for (size_t row = begin; row < end; ++row) {
          size_t js[2], ks[2];
          T wj[2], wk[2];
          const int nj = gather(fine.coarse[1], row % fine.n[1], js, wj), nk = gather(fine.coarse[2], row / fine.n[1], ks, wk);
          std::fill(sum.begin(), sum.end(), T(0));
          for (int k = 0; k < nk; ++k)
            for (int j = 0; j < nj; ++j) {
              const T weight = wk[k] * wj[j];
              const T* const from = coarse.row(js[j] + coarse.n[1] * ks[k]);
              for (size_t i = 0; i < coarse.n[0]; ++i) sum[i] += weight * from[i];
            }
          T* const to = x.row(row);
          for (size_t i = 0; i < coarse.n[0]; ++i) {
            const Stencil& s = fine.coarse[0][i];
            for (int a = 0; a < s.count; ++a) to[size_t(s.first + a)] += s.weight[a] * sum[i];
          }
        }
      },
      &context);
}

template <class T>
void Multigrid<T>::cycle(size_t level, const Lattice<T>& b, Lattice<T>& x, const Context& context) {
  Level& l = levels_[level];
  std::fill(x.values.begin(), x.values.end(), T(0));
  const bool last = level + 1 == levels_.size();
  const int sweeps = last ? coarsest_sweeps : 1;
  for (int s = 0; s < sweeps; ++s) smooth(l, b, x, 0, context), smooth(l, b, x, 1, context);
  if (!last) {
    Level& next = levels_[level + 1];
    residual(l, b, x, l.r, context);
    restrict_to(l, l.r, next.b, context);
    cycle(level + 1, next.b, next.x, context);
    prolong(l, next.x, x, context);
  }
  for (int s = 0; s < sweeps; ++s) smooth(l, b, x, 1, context), smooth(l, b, x, 0, context);
}

template <class T>
void Multigrid<T>::precondition(const Lattice<T>& b, Lattice<T>& x, const Context& context) {
  cycle(0, b, x, context);
}

template class Multigrid<float>;
template class Multigrid<double>;

}  // namespace sg::fluid
