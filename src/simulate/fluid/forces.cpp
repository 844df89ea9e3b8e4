// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/forces.h"

#include <cmath>
#include <type_traits>

#include "base/parallel.h"
#include "simulate/fluid/lattice_sums.h"

namespace sg::fluid {

namespace {

constexpr size_t force_rows = 16;

// Calls f(face, cell, stride) for the faces across an axis that lie between two cells: its number, and that of the cell above it, which is
// `stride` behind the one below.
template <class T, class F>
void inner_faces(const MacGrid& g, int axis, const Lattice<T>& l, const Context& context, F&& f) {
  const size_t a = size_t(axis), stride = a == 0 ? 1 : a == 1 ? g.cells[0] : g.cells[0] * g.cells[1];
  parallel_for(
      l.rows(), force_rows,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row)
          for (size_t i = 0; i < l.n[0]; ++i) {
            const std::array<size_t, 3> at{i, row % l.n[1], row / l.n[1]};
            if (at[a] == 0 || at[a] == g.cells[a]) continue;
            f(i + row * l.n[0], at[0] + g.cells[0] * (at[1] + g.cells[1] * at[2]), stride);
          }
      },
      &context);
}

// Velocity in the middle of a cell; indices are held at the border.
template <class T>
Vec3T<T> middle_velocity(const MacGrid& g, const Faces<T>& u, long i, long j, long k) {
  const auto hold = [&](long x, size_t a) { return size_t(std::min(std::max(x, 0l), long(g.cells[a]) - 1)); };
  const size_t x = hold(i, 0), y = hold(j, 1), z = hold(k, 2);
  return {(u[0](x, y, z) + u[0](x + 1, y, z)) / 2, (u[1](x, y, z) + u[1](x, y + 1, z)) / 2,
          g.flat() ? T(0) : (u[2](x, y, z) + u[2](x, y, z + 1)) / 2};
}

}  // namespace

template <class T>
void add_buoyancy(const MacGrid& g, const Lattice<T>& density, const Lattice<T>& temperature, Vec3 up, double weight, double lift,
                  double dt, Faces<T>& u, const Context& context) {
  for (int a = 0; a < g.axes(); ++a) {
    const T by_heat = T(dt * lift * up[a] / 2), by_weight = T(dt * weight * up[a] / 2);
    if (by_heat == 0 && by_weight == 0) continue;
    T* const v = u[size_t(a)].values.data();
    const T *heat = temperature.values.data(), *mass = density.values.data();
    inner_faces(g, a, u[size_t(a)], context, [&](size_t face, size_t cell, size_t stride) {
      v[face] += by_heat * (heat[cell] + heat[cell - stride]) - by_weight * (mass[cell] + mass[cell - stride]);
    });
  }
}

template <class T>
void confine_vortices(const MacGrid& g, double strength, double dt, Faces<T>& u, const Context& context) {
  if (strength == 0) return;
  const size_t count = g.cells[0] * g.cells[1] * g.cells[2];
  Plane<Vec3T<T>> vorticity(count);
  Lattice<T> size(g.cells);
  const T per = T(1 / (2 * g.h));
  parallel_for(
      size.rows(), force_rows,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row)
          for (size_t x = 0; x < g.cells[0]; ++x) {
            const long i = long(x), j = long(row % g.cells[1]), k = long(row / g.cells[1]);
            const Vec3T<T> by_x = per * (middle_velocity(g, u, i + 1, j, k) - middle_velocity(g, u, i - 1, j, k)),
                           by_y = per * (middle_velocity(g, u, i, j + 1, k) - middle_velocity(g, u, i, j - 1, k)),
                           by_z = per * (middle_velocity(g, u, i, j, k + 1) - middle_velocity(g, u, i, j, k - 1));
            const Vec3T<T> w{by_y.z - by_z.y, by_z.x - by_x.z, by_x.y - by_y.x};
            vorticity[x + row * g.cells[0]] = w, size.row(row)[x] = length(w);
          }
      },
      &context);
  Plane<Vec3T<T>> force(count);
  parallel_for(
      size.rows(), force_rows,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row)
          for (size_t x = 0; x < g.cells[0]; ++x) {
            const size_t at[3] = {x, row % g.cells[1], row / g.cells[1]}, cell = x + row * g.cells[0];
            const size_t strides[3] = {1, g.cells[0], g.cells[0] * g.cells[1]};
            Vec3T<T> to{};
            for (int a = 0; a < 3; ++a) {
              const size_t stride = strides[a];
              to[a] = per *
                      (size.values[at[a] + 1 < g.cells[size_t(a)] ? cell + stride : cell] - size.values[at[a] > 0 ? cell - stride : cell]);
            }
            const T steep = length(to);
            force[cell] = steep > 0 ? T(strength * g.h * dt / 2) / steep * cross(to, vorticity[cell]) : Vec3T<T>{};
          }
      },
      &context);
  for (int a = 0; a < g.axes(); ++a)
    inner_faces(g, a, u[size_t(a)], context,
                [&](size_t face, size_t cell, size_t stride) { u[size_t(a)].values[face] += force[cell][a] + force[cell - stride][a]; });
}

namespace {

// out = (I - r lap) x over the faces that move; r = viscosity dt / h^2.
template <class T>
void friction(const Lattice<T>& moves, T r, const Lattice<T>& x, Lattice<T>& out, const Context& context) {
  parallel_for(
      x.rows(), force_rows,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row)
          for (size_t i = 0; i < x.n[0]; ++i) {
            const size_t at[3] = {i, row % x.n[1], row / x.n[1]}, here = i + row * x.n[0];
            if (!(moves.values[here] > 0)) {
              out.values[here] = x.values[here];
              continue;
            }
            T sum = 0;
            size_t stride = 1;
            for (size_t a = 0; a < 3; stride *= x.n[a++]) {  // beyond the border the same value: nothing holds it there
              if (at[a] > 0) sum += x.values[here] - x.values[here - stride];
              if (at[a] + 1 < x.n[a]) sum += x.values[here] - x.values[here + stride];
            }
            out.values[here] = x.values[here] + r * sum;
          }
      },
      &context);
}

}  // namespace

template <class T>
void diffuse_velocity(const MacGrid& g, const Faces<T>& open, double viscosity, double dt, Faces<T>& u, const Context& context) {
  if (viscosity == 0) return;
  const T r = T(viscosity * dt / (g.h * g.h));
  const double tolerance = std::is_same_v<T, float> ? 1e-6 : 1e-12;
  for (int axis = 0; axis < g.axes(); ++axis) {
    Lattice<T>& x = u[size_t(axis)];
    for (size_t i = 0; i < x.values.size(); ++i)
      if (!(open[size_t(axis)].values[i] > 0)) x.values[i] = 0;
    Lattice<T> residual = x, q(x.n);
    // The values before are a good beginning.
    friction(open[size_t(axis)], r, x, q, context);
    for (size_t i = 0; i < q.values.size(); ++i) residual.values[i] -= q.values[i];
    Lattice<T> s = residual;
    double rr = dot(residual, residual, context);
    const double enough = tolerance * tolerance * dot(x, x, context);
    for (int step = 0; step < 1000 && rr > enough; ++step) {
      friction(open[size_t(axis)], r, s, q, context);
      const T alpha = T(rr / dot(s, q, context));
      for (size_t i = 0; i < q.values.size(); ++i) x.values[i] += alpha * s.values[i], residual.values[i] -= alpha * q.values[i];
      const double next = dot(residual, residual, context);
      const T beta = T(next / rr);
      rr = next;
      for (size_t i = 0; i < q.values.size(); ++i) s.values[i] = residual.values[i] + beta * s.values[i];
    }
  }
}

template void add_buoyancy(const MacGrid&, const Lattice<float>&, const Lattice<float>&, Vec3, double, double, double, Faces<float>&,
                           const Context&);
template void add_buoyancy(const MacGrid&, const Lattice<double>&, const Lattice<double>&, Vec3, double, double, double, Faces<double>&,
                           const Context&);
template void confine_vortices(const MacGrid&, double, double, Faces<float>&, const Context&);
template void confine_vortices(const MacGrid&, double, double, Faces<double>&, const Context&);
template void diffuse_velocity(const MacGrid&, const Faces<float>&, double, double, Faces<float>&, const Context&);
template void diffuse_velocity(const MacGrid&, const Faces<double>&, double, double, Faces<double>&, const Context&);

}  // namespace sg::fluid
