// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/pressure/multigrid.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"

namespace sg::fluid {

namespace {

constexpr size_t row_grain = 32;
constexpr size_t coarsest = 64;  // cells that sweeps alone solve
constexpr int coarsest_sweeps = 16;
/// Coarse cells that are open by less, of six faces, are closed.
constexpr double narrowest = 0.1;

// Row (j, k) of cells, the rows about it and the open shares of its faces; outside of the box there are zeros.
template <class T>
struct Rows {
  size_t n;
  const T *here, *south, *north, *below, *above;
  T x, y0, y1, z0, z1, west, east;                                                        // couplings; the last two at the ends
  const T *wx = nullptr, *wy0 = nullptr, *wy1 = nullptr, *wz0 = nullptr, *wz1 = nullptr;  // shares; none in plain rows

  Rows(const std::array<size_t, 3>& cells, const std::array<T, 3>& coupling, const Walls<T>& walls, bool plain, const Lattice<T>& v,
       const T* zeros, size_t row)
      : n(cells[0]) {
    const size_t j = row % cells[1], k = row / cells[1];
    here = v.row(row);
    south = j > 0 ? here - n : zeros, north = j + 1 < cells[1] ? here + n : zeros;
    below = k > 0 ? here - n * cells[1] : zeros, above = k + 1 < cells[2] ? here + n * cells[1] : zeros;
    // Half the distance to open sides.
    const auto at_side = [&](size_t axis, size_t side, bool there) {
      return there ? coupling[axis] * T(walls.sides[2 * axis + side] ? 2 : 0) : coupling[axis];
    };
    x = coupling[0], west = at_side(0, 0, true), east = at_side(0, 1, true);
    y0 = at_side(1, 0, j == 0), y1 = at_side(1, 1, j + 1 == cells[1]);
    z0 = at_side(2, 0, k == 0), z1 = at_side(2, 1, k + 1 == cells[2]);
    if (!walls.obstacles()) return;
    const auto& w = walls.open;
    const size_t y = j + (cells[1] + 1) * k;
    if (plain) {  // alike along the row
      y0 *= w[1].row(y)[0], y1 *= w[1].row(y + 1)[0], z0 *= w[2].row(row)[0], z1 *= w[2].row(row + cells[1])[0];
      west *= w[0].row(row)[0], east *= w[0].row(row)[n];
      return;
    }
    wx = w[0].row(row), wy0 = w[1].row(y), wy1 = w[1].row(y + 1), wz0 = w[2].row(row), wz1 = w[2].row(row + cells[1]);
  }

  // Sums over the faces of cell i, of c w p of the neighbours and of c w.
  void sums_at(size_t i, T& neighbours, T& diagonal) const {
    const auto share = [&](const T* w, size_t at) { return w ? w[at] : T(1); };
    const T cw = (i > 0 ? x : west) * share(wx, i), ce = (i + 1 < n ? x : east) * share(wx, i + 1), cs = y0 * share(wy0, i),
            cn = y1 * share(wy1, i), cb = z0 * share(wz0, i), ca = z1 * share(wz1, i);
    const T pw = i > 0 ? here[i - 1] : T(0), pe = i + 1 < n ? here[i + 1] : T(0);
    neighbours = (cw * pw + ce * pe) + (cs * south[i] + cn * north[i]) + (cb * below[i] + ca * above[i]);
    diagonal = (cw + ce) + (cs + cn) + (cb + ca);
  }
  T plain_sum(size_t i) const {  // of the neighbours of a cell that is not at an end
    return x * (here[i - 1] + here[i + 1]) + (y0 * south[i] + y1 * north[i]) + (z0 * below[i] + z1 * above[i]);
  }
  T plain_diagonal() const { return (x + x) + (y0 + y1) + (z0 + z1); }

  // Of all cells.
  void sums(T* neighbours, T* diagonal) const {
    sums_at(0, neighbours[0], diagonal[0]);
    if (n > 1) sums_at(n - 1, neighbours[n - 1], diagonal[n - 1]);
    if (wx) {
      for (size_t i = 1; i + 1 < n; ++i) {
        const T cw = x * wx[i], ce = x * wx[i + 1], cs = y0 * wy0[i], cn = y1 * wy1[i], cb = z0 * wz0[i], ca = z1 * wz1[i];
        neighbours[i] = (cw * here[i - 1] + ce * here[i + 1]) + (cs * south[i] + cn * north[i]) + (cb * below[i] + ca * above[i]);
        diagonal[i] = (cw + ce) + (cs + cn) + (cb + ca);
      }
      return;
    }
    for (size_t i = 1; i + 1 < n; ++i) neighbours[i] = plain_sum(i);
    std::fill(diagonal + 1, diagonal + std::max<size_t>(n, 2) - 1, plain_diagonal());
  }

  // Every second cell from `first` on as its neighbours want it, but for those of air; `to` is the row itself.
  void relax(const T* b, T* to, size_t first, const uint8_t* air) const {
    const auto relax_at = [&](size_t i) {
      T neighbours, diagonal;
      sums_at(i, neighbours, diagonal);
      to[i] = diagonal > 0 ? (b[i] + neighbours) / diagonal : T(0);  // dry cells take no part
    };
    if (wx || air || plain_diagonal() <= 0) {
      for (size_t i = first; i < n; i += 2)
        if (!air || !air[i]) relax_at(i);
      return;
    }
    const T inverse = 1 / plain_diagonal();
    size_t i = first;
    if (i == 0) relax_at(0), i = 2;
    for (; i + 1 < n; i += 2) to[i] = (b[i] + plain_sum(i)) * inverse;
    if (i < n) relax_at(i);
  }
};

// The mean of the fine faces that make up each coarse one; those that are missing beyond an odd border count as solid.
template <class T>
Lattice<T> coarse_faces(const Walls<T>& fine, int axis, const std::array<size_t, 3>& cells, const std::array<size_t, 3>& coarse_cells,
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
            for (size_t x = lo[0]; x < hi[0]; ++x) sum += fine.share(cells, axis, x, y, z);
        out(i, j, k) = sum / parts;
      }
  return out;
}

// Closes cells that are all but solid: what they are given of the residual around them they would answer with a huge pressure.
template <class T>
void close_narrow_cells(const std::array<size_t, 3>& n, Faces<T>& open) {
  auto& [x, y, z] = open;
  for (bool closed = true; closed;) {  // until what is closed leaves no neighbour narrow
    closed = false;
    for (size_t k = 0; k < n[2]; ++k)
      for (size_t j = 0; j < n[1]; ++j)
        for (size_t i = 0; i < n[0]; ++i) {
          const T sum = (x(i, j, k) + x(i + 1, j, k)) + (y(i, j, k) + y(i, j + 1, k)) + (z(i, j, k) + z(i, j, k + 1));
          if (!(sum > 0 && sum < T(narrowest))) continue;
          x(i, j, k) = x(i + 1, j, k) = y(i, j, k) = y(i, j + 1, k) = z(i, j, k) = z(i, j, k + 1) = 0, closed = true;
        }
  }
}

}  // namespace

template <class T>
Multigrid<T>::Multigrid(std::array<size_t, 3> cells, Walls<T> walls) {
  std::array<double, 3> h{1, 1, 1};
  levels_.push_back({cells, {1, 1, 1}, std::move(walls), {}, {}, {}, {}, {}, {}});
  levels_.front().walls.close_sides();
  find_plain_rows(levels_.front());
  for (;;) {
    Level& fine = levels_.back();
    std::array<bool, 3> halved{};
    std::array<size_t, 3> n = fine.n;
    for (size_t a = 0; a < 3; ++a) halved[a] = n[a] > 2, n[a] = halved[a] ? (n[a] + 1) / 2 : n[a];
    if (fine.n[0] * fine.n[1] * fine.n[2] <= coarsest || n == fine.n) break;
    Level next;
    next.n = n;
    next.walls.sides = fine.walls.sides;
    for (size_t a = 0; a < 3; ++a) {
      h[a] *= halved[a] ? 2 : 1;
      next.walls.open[a] = coarse_faces(fine.walls, int(a), fine.n, n, halved);
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
        take_part(own, i, outside ? (fine.walls.sides[2 * a + (up ? 1 : 0)] ? T(0.5) : T(1)) : T(0.75));
        if (!outside) take_part(up ? own + 1 : own - 1, i, T(0.25));
      }
    }
    close_narrow_cells(n, next.walls.open);
    next.coupling = {T(h[1] * h[2] / h[0]), T(h[0] * h[2] / h[1]), T(h[0] * h[1] / h[2])};
    next.x = next.b = next.r = Lattice<T>(n);
    find_plain_rows(next);
    levels_.push_back(std::move(next));
  }
}

template <class T>
void Multigrid<T>::find_plain_rows(Level& l) {
  const size_t rows = l.n[1] * l.n[2];
  l.plain.assign(rows, 1);
  if (!l.walls.obstacles()) return;
  const auto& w = l.walls.open;
  const auto alike = [&](const T* v) { return std::all_of(v, v + l.n[0], [&](T x) { return x == v[0]; }); };
  for (size_t row = 0; row < rows; ++row) {
    const size_t y = row % l.n[1] + (l.n[1] + 1) * (row / l.n[1]);
    const T* const x = w[0].row(row);
    l.plain[row] = std::all_of(x + 1, x + l.n[0], [](T v) { return v == 1; }) && alike(w[1].row(y)) && alike(w[1].row(y + 1)) &&
                   alike(w[2].row(row)) && alike(w[2].row(row + l.n[1]));
  }
}

// Sets the cells of air in a row to 0.
template <class T>
void Multigrid<T>::clear_air(const Level& l, size_t row, T* to) {
  if (l.air.empty()) return;
  const uint8_t* const air = l.air.data() + row * l.n[0];
  for (size_t i = 0; i < l.n[0]; ++i) to[i] = air[i] ? T(0) : to[i];
}

template <class T>
void Multigrid<T>::set_air(std::vector<uint8_t> air) {
  levels_.front().air = std::move(air);
  for (size_t level = 1; level < levels_.size(); ++level) {
    const Level& fine = levels_[level - 1];
    Level& l = levels_[level];
    l.air.clear();
    if (fine.air.empty()) continue;
    l.air.assign(l.n[0] * l.n[1] * l.n[2], 0);
    std::array<size_t, 3> step;
    for (size_t a = 0; a < 3; ++a) step[a] = l.n[a] == fine.n[a] ? 1 : 2;
    for (size_t k = 0; k < fine.n[2]; ++k)
      for (size_t j = 0; j < fine.n[1]; ++j)
        for (size_t i = 0; i < fine.n[0]; ++i)
          l.air[i / step[0] + l.n[0] * (j / step[1] + l.n[1] * (k / step[2]))] |= fine.air[i + fine.n[0] * (j + fine.n[1] * k)];
  }
}

// Calls f(row, its Rows) for every row of cells.
template <class T>
template <class F>
void Multigrid<T>::each_row(const Level& l, const Lattice<T>& x, const Context& context, F&& f) {
  const std::vector<T> zeros(l.n[0]);
  parallel_for(
      x.rows(), row_grain,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) f(row, Rows<T>(l.n, l.coupling, l.walls, l.plain[row], x, zeros.data(), row));
      },
      &context);
}

// Calls f(row, neighbours, diagonal) with the sums of every row of cells.
template <class T>
template <class F>
void Multigrid<T>::each_sum(const Level& l, const Lattice<T>& x, const Context& context, F&& f) {
  each_row(l, x, context, [&](size_t row, const Rows<T>& rows) {
    thread_local std::vector<T> sums;
    if (sums.size() < 2 * l.n[0]) sums.resize(2 * l.n[0]);
    T *const neighbours = sums.data(), *const diagonal = neighbours + l.n[0];
    rows.sums(neighbours, diagonal);
    f(row, neighbours, diagonal);
  });
}

template <class T>
void Multigrid<T>::apply(const Lattice<T>& x, Lattice<T>& out, const Context& context) const {
  const Level& l = levels_.front();
  each_sum(l, x, context, [&](size_t row, const T* neighbours, const T* diagonal) {
    const T* const p = x.row(row);
    T* const to = out.row(row);
    for (size_t i = 0; i < l.n[0]; ++i) to[i] = diagonal[i] * p[i] - neighbours[i];
    clear_air(l, row, to);
  });
}

template <class T>
void Multigrid<T>::residual(const Level& l, const Lattice<T>& b, const Lattice<T>& x, Lattice<T>& r, const Context& context) const {
  each_sum(l, x, context, [&](size_t row, const T* neighbours, const T* diagonal) {
    const T *const p = x.row(row), *const from = b.row(row);
    T* const to = r.row(row);
    for (size_t i = 0; i < l.n[0]; ++i) {  // dry cells take no part
      const T left = from[i] - (diagonal[i] * p[i] - neighbours[i]);
      to[i] = diagonal[i] > 0 ? left : T(0);
    }
    clear_air(l, row, to);
  });
}

// One colour of the chessboard.
template <class T>
void Multigrid<T>::smooth(const Level& l, const Lattice<T>& b, Lattice<T>& x, int color, const Context& context) const {
  each_row(l, x, context, [&](size_t row, const Rows<T>& rows) {
    rows.relax(b.row(row), x.row(row), (size_t(color) + row % l.n[1] + row / l.n[1]) % 2, l.air.empty() ? nullptr : &l.air[row * l.n[0]]);
  });
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
        const size_t n = coarse.n[0];
        const bool halved = n != fine.n[0];
        std::vector<T> padded(n + 2);
        T* const sum = padded.data() + 1;
        for (size_t row = begin; row < end; ++row) {
          size_t js[2], ks[2];
          T wj[2], wk[2];
          const int nj = gather(fine.coarse[1], row % fine.n[1], js, wj), nk = gather(fine.coarse[2], row / fine.n[1], ks, wk);
          std::fill(padded.begin(), padded.end(), T(0));
          for (int k = 0; k < nk; ++k)
            for (int j = 0; j < nj; ++j) {
              const T weight = wk[k] * wj[j];
              const T* const from = coarse.row(js[j] + coarse.n[1] * ks[k]);
              for (size_t i = 0; i < n; ++i) sum[i] += weight * from[i];
            }
          T* const to = x.row(row);
          if (!halved) {
            for (size_t i = 0; i < n; ++i) to[i] += sum[i];
            continue;
          }
          // Beyond walls lies the same value, beyond open sides the opposite one.
          sum[-1] = fine.walls.sides[0] ? -sum[0] : sum[0], sum[n] = fine.walls.sides[1] ? -sum[n - 1] : sum[n - 1];
          const size_t pairs = fine.n[0] / 2;
          for (size_t i = 0; i < pairs; ++i) {
            const T own = T(0.75) * sum[i];
            to[2 * i] += own + T(0.25) * sum[ptrdiff_t(i) - 1], to[2 * i + 1] += own + T(0.25) * sum[i + 1];
          }
          if (fine.n[0] % 2) to[2 * pairs] += T(0.75) * sum[pairs] + T(0.25) * sum[pairs - 1];
        }
      },
      &context);
}

template <class T>
void Multigrid<T>::cycle(size_t level, const Lattice<T>& b, Lattice<T>& x, Lattice<T>& r, const Context& context) {
  Level& l = levels_[level];
  std::fill(x.values.begin(), x.values.end(), T(0));
  const bool last = level + 1 == levels_.size();
  const int sweeps = last ? coarsest_sweeps : 1;
  for (int s = 0; s < sweeps; ++s) smooth(l, b, x, 0, context), smooth(l, b, x, 1, context);
  if (!last) {
    Level& next = levels_[level + 1];
    residual(l, b, x, r, context);
    restrict_to(l, r, next.b, context);
    cycle(level + 1, next.b, next.x, next.r, context);
    prolong(l, next.x, x, context);
    if (!l.air.empty())
      for (size_t row = 0; row < x.rows(); ++row) clear_air(l, row, x.row(row));
  }
  for (int s = 0; s < sweeps; ++s) smooth(l, b, x, 1, context), smooth(l, b, x, 0, context);
}

template <class T>
void Multigrid<T>::precondition(const Lattice<T>& b, Lattice<T>& x, Lattice<T>& spare, const Context& context) {
  cycle(0, b, x, spare, context);
}

template class Multigrid<float>;
template class Multigrid<double>;

}  // namespace sg::fluid
