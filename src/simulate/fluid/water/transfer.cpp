// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/water/transfer.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"

namespace sg::fluid {

void particles_to_faces(const MacGrid& g, const std::vector<Particle3>& particles, const std::vector<uint32_t>& begin, Faces<double>& u,
                        Faces<double>& weight, const Context& context) {
  for (size_t a = 0; a < 3; ++a)
    for (Lattice<double>* l : {&u[a], &weight[a]}) std::fill(l->values.begin(), l->values.end(), 0.0);
  each_to_places(g, begin, context, [&](size_t p) {
    const Particle3& q = particles[p];
    for (int a = 0; a < g.axes(); ++a) {
      const auto shift = MacGrid::shift(a);
      Lattice<double>&sum = u[size_t(a)], &mass = weight[size_t(a)];
      Corners(sum.n, a, q.x).each([&](const std::array<size_t, 3>& at, double w, const auto&) {
        Vec3 way = Vec3(double(at[0]) + shift[0], double(at[1]) + shift[1], double(at[2]) + shift[2]) - q.x;
        if (g.flat()) way.z = 0;
        sum(at[0], at[1], at[2]) += w * (q.v[a] + dot(q.c[size_t(a)], way)), mass(at[0], at[1], at[2]) += w;
      });
    }
  });
  for (size_t a = 0; a < 3; ++a)
    for (size_t i = 0; i < u[a].values.size(); ++i)
      if (const double w = weight[a].values[i]; w > 0) u[a].values[i] /= w;
}

Vec3 velocity_at(const MacGrid& g, const Faces<double>& u, const Vec3& x, std::array<Vec3, 3>* c) {
  Vec3 v;
  for (int a = 0; a < g.axes(); ++a) {
    const Lattice<double>& l = u[size_t(a)];
    const Corners corners(l.n, a, x);
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
