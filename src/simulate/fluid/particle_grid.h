// SPDX-License-Identifier: Apache-2.0
// Particles among the places of a staggered grid: which ones are about them, and with which weights.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/context.h"
#include "base/parallel.h"
#include "simulate/fluid/mac_grid.h"

namespace sg::fluid {

/// The places of a lattice about a point, and the shares of linear interpolation; held at the border.
struct Corners {
  std::array<size_t, 3> at{};
  std::array<double, 3> share{};  ///< of the upper neighbour
  std::array<size_t, 3> next{};   ///< 1, or 0 along axes of one place

  /// Of faces across `axis` (-1: cells), n along each axis; x is from the grid's origin, in units of h.
  Corners(const std::array<size_t, 3>& n, int axis, const Vec3& x) {
    const auto shift = MacGrid::shift(axis);
    for (size_t a = 0; a < 3; ++a) {
      if (n[a] < 2) continue;
      const double p = std::clamp(x[int(a)] - shift[a], 0.0, double(n[a] - 1));
      at[a] = std::min(size_t(p), n[a] - 2), share[a] = p - double(at[a]), next[a] = 1;
    }
  }
  /// Calls f(place, weight, offset from the lower corner along each axis) for the corners.
  template <class F>
  void each(F&& f) const {
    for (size_t k = 0; k <= next[2]; ++k)
      for (size_t j = 0; j <= next[1]; ++j)
        for (size_t i = 0; i <= next[0]; ++i)
          f(std::array{at[0] + i, at[1] + j, at[2] + k},
            (i ? share[0] : 1 - share[0]) * (j ? share[1] : 1 - share[1]) * (k ? share[2] : 1 - share[2]), std::array{i, j, k});
  }
};

/// The cell that x lies in, or the nearest one.
inline size_t cell_of(const MacGrid& g, const Vec3& x) {
  const auto along = [&](int a) { return size_t(std::clamp(x[a], 0.0, double(g.cells[size_t(a)]) - 0.5)); };
  return along(0) + g.cells[0] * (along(1) + g.cells[1] * (g.flat() ? 0 : along(2)));
}

/// Sorts particles, whose x is in units of h from the origin, by the cells that they lie in; returns where each cell's begin, one more than
/// there are cells.
template <class P>
std::vector<uint32_t> sort_by_cell(const MacGrid& g, std::vector<P>& particles) {
  const size_t cells = g.cells[0] * g.cells[1] * g.cells[2];
  std::vector<uint32_t> begin(cells + 1);
  std::vector<uint32_t> cell(particles.size());
  for (size_t p = 0; p < particles.size(); ++p) cell[p] = uint32_t(cell_of(g, particles[p].x)), ++begin[cell[p] + 1];
  for (size_t c = 0; c < cells; ++c) begin[c + 1] += begin[c];
  std::vector<P> sorted(particles.size());
  std::vector<uint32_t> next(begin.begin(), begin.end() - 1);
  for (size_t p = 0; p < particles.size(); ++p) sorted[next[cell[p]]++] = particles[p];
  particles = std::move(sorted);
  return begin;
}

/// Calls f(p) for all particles, sorted by cell, so that each may add to the places about it: the sums are the same for any number of
/// threads.
template <class F>
void each_to_places(const MacGrid& g, const std::vector<uint32_t>& begin, const Context& context, F&& f) {
  constexpr size_t slab = 4;  // layers of cells whose particles are taken in order; every second one is free of the others'
  const size_t layers = g.flat() ? g.cells[1] : g.cells[2], layer_cells = g.flat() ? g.cells[0] : g.cells[0] * g.cells[1];
  const size_t slabs = (layers + slab - 1) / slab;
  for (size_t parity = 0; parity < 2; ++parity)
    parallel_for((slabs + 1 - parity) / 2, 1,
                 [&](size_t first, size_t last) {
                   for (size_t s = first; s < last; ++s) {
                     const size_t from = (2 * s + parity) * slab, to = std::min(from + slab, layers);
                     for (size_t p = begin[from * layer_cells]; p < begin[to * layer_cells]; ++p) f(p);
                   }
                 },
                 &context);
}

}  // namespace sg::fluid
