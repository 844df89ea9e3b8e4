// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/water/transfer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"

namespace sg::fluid {

namespace {

constexpr size_t slab = 4;  // layers of cells whose particles are taken in order; every second one is free of the others'

// The places of a lattice about a point, and the shares of linear interpolation; held at the border.
struct Corners {
  std::array<size_t, 3> at{};
  std::array<double, 3> share{};  // of the upper neighbour
  std::array<size_t, 3> next{};   // 1, or 0 along axes of one place

  Corners(const Lattice<double>& l, int axis, const Vec3& x) {
    const auto shift = MacGrid::shift(axis);
    for (size_t a = 0; a < 3; ++a) {
      if (l.n[a] < 2) continue;
      const double p = std::clamp(x[int(a)] - shift[a], 0.0, double(l.n[a] - 1));
      at[a] = std::min(size_t(p), l.n[a] - 2), share[a] = p - double(at[a]), next[a] = 1;
    }
  }
  // Calls f(place, weight, offset from the lower corner along each axis) for the corners.
  template <class F>
  void each(F&& f) const {
    for (size_t k = 0; k <= next[2]; ++k)
      for (size_t j = 0; j <= next[1]; ++j)
        for (size_t i = 0; i <= next[0]; ++i)
          f(std::array{at[0] + i, at[1] + j, at[2] + k},
            (i ? share[0] : 1 - share[0]) * (j ? share[1] : 1 - share[1]) * (k ? share[2] : 1 - share[2]), std::array{i, j, k});
  }
};

size_t cell_of(const MacGrid& g, const Vec3& x) {
  const auto along = [&](int a) { return size_t(std::clamp(x[a], 0.0, double(g.cells[size_t(a)]) - 0.5)); };
  return along(0) + g.cells[0] * (along(1) + g.cells[1] * (g.flat() ? 0 : along(2)));
}

}  // namespace

std::vector<uint32_t> sort_by_cell(const MacGrid& g, std::vector<Particle3>& particles) {
  const size_t cells = g.cells[0] * g.cells[1] * g.cells[2];
  std::vector<uint32_t> begin(cells + 1);
  std::vector<uint32_t> cell(particles.size());
  for (size_t p = 0; p < particles.size(); ++p) cell[p] = uint32_t(cell_of(g, particles[p].x)), ++begin[cell[p] + 1];
  for (size_t c = 0; c < cells; ++c) begin[c + 1] += begin[c];
  std::vector<Particle3> sorted(particles.size());
  std::vector<uint32_t> next(begin.begin(), begin.end() - 1);
  for (size_t p = 0; p < particles.size(); ++p) sorted[next[cell[p]]++] = particles[p];
  particles = std::move(sorted);
  return begin;
}

void particles_to_faces(const MacGrid& g, const std::vector<Particle3>& particles, const std::vector<uint32_t>& begin, Faces<double>& u,
                        Faces<double>& weight, const Context& context) {
  for (size_t a = 0; a < 3; ++a)
    for (Lattice<double>* l : {&u[a], &weight[a]}) std::fill(l->values.begin(), l->values.end(), 0.0);
  const size_t layers = g.flat() ? g.cells[1] : g.cells[2], layer_cells = g.flat() ? g.cells[0] : g.cells[0] * g.cells[1];
  const size_t slabs = (layers + slab - 1) / slab;
  for (size_t parity = 0; parity < 2; ++parity)
    parallel_for((slabs + 1 - parity) / 2, 1,
                 [&](size_t first, size_t last) {
                   for (size_t s = first; s < last; ++s) {
                     const size_t from = (2 * s + parity) * slab, to = std::min(from + slab, layers);
                     for (size_t p = begin[from * layer_cells]; p < begin[to * layer_cells]; ++p) {
                       const Particle3& q = particles[p];
                       for (int a = 0; a < g.axes(); ++a) {
                         const auto shift = MacGrid::shift(a);
                         Lattice<double>&sum = u[size_t(a)], &mass = weight[size_t(a)];
                         Corners(sum, a, q.x).each([&](const std::array<size_t, 3>& at, double w, const auto&) {
                           Vec3 way = Vec3(double(at[0]) + shift[0], double(at[1]) + shift[1], double(at[2]) + shift[2]) - q.x;
                           if (g.flat()) way.z = 0;
                           sum(at[0], at[1], at[2]) += w * (q.v[a] + dot(q.c[size_t(a)], way)), mass(at[0], at[1], at[2]) += w;
                         });
                       }
                     }
                   }
                 },
                 &context);
  for (size_t a = 0; a < 3; ++a)
    for (size_t i = 0; i < u[a].values.size(); ++i)
      if (const double w = weight[a].values[i]; w > 0) u[a].values[i] /= w;
}

Vec3 velocity_at(const MacGrid& g, const Faces<double>& u, const Vec3& x, std::array<Vec3, 3>* c) {
  Vec3 v;
  for (int a = 0; a < g.axes(); ++a) {
    const Lattice<double>& l = u[size_t(a)];
    const Corners corners(l, a, x);
    Vec3 slope;
    corners.each([&](const std::array<size_t, 3>& at, double w, const std::array<size_t, 3>& offset) {
      const double value = l(at[0], at[1], at[2]);
      v[a] += w * value;
      if (!c) return;
      for (size_t b = 0; b < 3; ++b) {  // the derivative of the weight along an axis
        if (corners.next[b] == 0) continue;
        double d = offset[b] ? 1 : -1;
        for (size_t other = 0; other < 3; ++other)
          if (other != b) d *= offset[other] ? corners.share[other] : 1 - corners.share[other];
        slope[int(b)] += d * value;
      }
    });
    if (c) (*c)[size_t(a)] = slope;
  }
  return v;
}

void extrapolate(const MacGrid& g, Faces<double>& u, Faces<double>& known, int layers, const Context& context) {
  for (int a = 0; a < g.axes(); ++a) {
    Lattice<double>&l = u[size_t(a)], &have = known[size_t(a)];
    Lattice<double> next = l, then = have;
    const size_t stride[3] = {1, l.n[0], l.n[0] * l.n[1]};
    for (int layer = 0; layer < layers; ++layer) {
      parallel_for(
          l.rows(), 16,
          [&](size_t begin, size_t end) {
            for (size_t row = begin; row < end; ++row)
              for (size_t i = 0; i < l.n[0]; ++i) {
                const size_t at[3] = {i, row % l.n[1], row / l.n[1]}, here = i + row * l.n[0];
                if (have.values[here] > 0) continue;
                double sum = 0, count = 0;
                for (size_t b = 0; b < 3; ++b) {
                  if (at[b] > 0 && have.values[here - stride[b]] > 0) sum += l.values[here - stride[b]], ++count;
                  if (at[b] + 1 < l.n[b] && have.values[here + stride[b]] > 0) sum += l.values[here + stride[b]], ++count;
                }
                if (count > 0) next.values[here] = sum / count, then.values[here] = 1;
              }
          },
          &context);
      l.values = next.values, have.values = then.values;
    }
  }
}

}  // namespace sg::fluid
