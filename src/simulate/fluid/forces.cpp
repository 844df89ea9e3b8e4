// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/forces.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

#include "base/parallel.h"
#include "simulate/fluid/lattice_sums.h"

namespace sg::fluid {

namespace {

constexpr size_t force_rows = 16;

// Calls f(faces, cells, stride) for the rows of faces across an axis that lie between cells: the numbers of the first of `count` faces and
// of the cell above it, which is `stride` behind the one below.
template <class T, class F>
void inner_rows(const MacGrid& g, int axis, const Lattice<T>& l, const Context& context, F&& f) {
  const size_t a = size_t(axis), stride = a == 0 ? 1 : a == 1 ? g.cells[0] : g.cells[0] * g.cells[1];
  parallel_for(
      l.rows(), force_rows,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) {
          const std::array<size_t, 3> at{0, row % l.n[1], row / l.n[1]};
          if (a > 0 && (at[a] == 0 || at[a] == g.cells[a])) continue;
          const size_t first = a == 0 ? 1 : 0;
          f(first + row * l.n[0], first + g.cells[0] * (at[1] + g.cells[1] * at[2]), g.cells[0] - first, stride);
        }
      },
      &context);
}

// The rows of cells about a row, held at the border, and the velocity in their middles.
template <class T>
struct Middles {
  const MacGrid& g;
  const Faces<T>& u;

  // Component a in the middle of cell i of row (j, k) held at the border.
  void row(size_t a, long j, long k, T* to) const {
    const size_t y = size_t(std::clamp(j, 0l, long(g.cells[1]) - 1)), z = size_t(std::clamp(k, 0l, long(g.cells[2]) - 1));
    const Lattice<T>& l = u[a];
    const T* const below = l.row(y + l.n[1] * z);
    const T* const above = a == 0 ? below + 1 : l.row(a == 1 ? y + 1 + l.n[1] * z : y + l.n[1] * (z + 1));
    for (size_t i = 0; i < g.cells[0]; ++i) to[i] = (below[i] + above[i]) / 2;
  }
};

// to[i] += by * (f[i+1] - f[i-1]), held at the ends.
template <class T>
void add_difference(const T* f, size_t n, T by, T* to) {
  if (n < 2) return;
  to[0] += by * (f[1] - f[0]), to[n - 1] += by * (f[n - 1] - f[n - 2]);
  for (size_t i = 1; i + 1 < n; ++i) to[i] += by * (f[i + 1] - f[i - 1]);
}

}  // namespace

template <class T>
void add_buoyancy(const MacGrid& g, const OpenSides& open, const Lattice<T>& density, const Lattice<T>& temperature, Vec3 up, double weight,
                  double lift, double dt, Faces<T>& u, const Context& context) {
  for (int a = 0; a < g.axes(); ++a) {
    const T by_heat = T(dt * lift * up[a] / 2), by_weight = T(dt * weight * up[a] / 2);
    if (by_heat == 0 && by_weight == 0) continue;
    inner_rows(g, a, u[size_t(a)], context, [&](size_t faces, size_t cells, size_t count, size_t stride) {
      T* const v = u[size_t(a)].values.data() + faces;
      const T *heat = temperature.values.data() + cells, *mass = density.values.data() + cells;
      const T *heat_below = heat - stride, *mass_below = mass - stride;
      for (size_t i = 0; i < count; ++i) v[i] += by_heat * (heat[i] + heat_below[i]) - by_weight * (mass[i] + mass_below[i]);
    });
    for (size_t side = 0; side < 2; ++side) {
      if (!open[2 * size_t(a) + side]) continue;
      std::array<size_t, 3> lo{0, 0, 0}, hi = g.cells;
      lo[size_t(a)] = side ? g.cells[size_t(a)] - 1 : 0, hi[size_t(a)] = lo[size_t(a)] + 1;
      for (size_t k = lo[2]; k < hi[2]; ++k)
        for (size_t j = lo[1]; j < hi[1]; ++j)
          for (size_t i = lo[0]; i < hi[0]; ++i) {
            std::array<size_t, 3> face{i, j, k};
            face[size_t(a)] += side;
            u[size_t(a)](face[0], face[1], face[2]) += 2 * (by_heat * temperature(i, j, k) - by_weight * density(i, j, k));
          }
    }
  }
}

template <class T>
void confine_vortices(const MacGrid& g, double strength, double dt, Faces<T>& u, Spare<T> spare, const Context& context) {
  if (strength == 0) return;
  const size_t n = g.cells[0];
  Lattice<T>* const w[3] = {&shaped(spare[0], g.cells), &shaped(spare[1], g.cells), &shaped(spare[2], g.cells)};
  Lattice<T>& size = shaped(spare[3], g.cells);
  const T per = T(1 / (2 * g.h));
  // The vorticity curl u of the middles, and its size.
  parallel_for(
      size.rows(), force_rows,
      [&](size_t begin, size_t end) {
        std::vector<T> line(2 * n);
        T *const after = line.data(), *const before = after + n;
        const Middles<T> middles{g, u};
        for (size_t row = begin; row < end; ++row) {
          const long j = long(row % g.cells[1]), k = long(row / g.cells[1]);
          T* const to[3] = {w[0]->row(row), w[1]->row(row), w[2]->row(row)};
          for (T* t : to) std::fill(t, t + n, T(0));
          // to[c] += sign * d u_a / d x_b
          const auto add = [&](size_t c, size_t a, size_t b, T sign) {
            if (int(a) >= g.axes() || int(b) >= g.axes()) return;
            if (b == 0) {
              middles.row(a, j, k, after);
              add_difference(after, n, sign * per, to[c]);
              return;
            }
            middles.row(a, b == 1 ? j + 1 : j, b == 2 ? k + 1 : k, after), middles.row(a, b == 1 ? j - 1 : j, b == 2 ? k - 1 : k, before);
            for (size_t i = 0; i < n; ++i) to[c][i] += sign * per * (after[i] - before[i]);
          };
          for (size_t c = 0; c < 3; ++c) add(c, (c + 2) % 3, (c + 1) % 3, 1), add(c, (c + 1) % 3, (c + 2) % 3, -1);
          T* const s = size.row(row);
          for (size_t i = 0; i < n; ++i) s[i] = std::sqrt(to[0][i] * to[0][i] + to[1][i] * to[1][i] + to[2][i] * to[2][i]);
        }
      },
      &context);
  // The force strength h N x curl u, N the direction in which vorticity grows, in place of the vorticity; its share of a face.
  const T by = T(strength * g.h * dt / 2);
  parallel_for(
      size.rows(), force_rows,
      [&](size_t begin, size_t end) {
        std::vector<T> slope(3 * n);
        T* const to[3] = {slope.data(), slope.data() + n, slope.data() + 2 * n};
        for (size_t row = begin; row < end; ++row) {
          const size_t j = row % g.cells[1], k = row / g.cells[1], plane = g.cells[1];
          std::fill(slope.begin(), slope.end(), T(0));
          add_difference(size.row(row), n, per, to[0]);
          const T *const north = size.row(j + 1 < g.cells[1] ? row + 1 : row), *const south = size.row(j > 0 ? row - 1 : row),
                         *const top = size.row(k + 1 < g.cells[2] ? row + plane : row), *const bottom = size.row(k > 0 ? row - plane : row);
          for (size_t i = 0; i < n; ++i) to[1][i] = per * (north[i] - south[i]), to[2][i] = per * (top[i] - bottom[i]);
          T *const wx = w[0]->row(row), *const wy = w[1]->row(row), *const wz = w[2]->row(row);
          for (size_t i = 0; i < n; ++i) {
            const T x = to[0][i], y = to[1][i], z = to[2][i], steep = std::sqrt(x * x + y * y + z * z), f = steep > 0 ? by / steep : T(0);
            const T a = wx[i], b = wy[i], c = wz[i];
            wx[i] = f * (y * c - z * b), wy[i] = f * (z * a - x * c), wz[i] = f * (x * b - y * a);
          }
        }
      },
      &context);
  for (int a = 0; a < g.axes(); ++a)
    inner_rows(g, a, u[size_t(a)], context, [&](size_t faces, size_t cells, size_t count, size_t stride) {
      T* const v = u[size_t(a)].values.data() + faces;
      const T *force = w[a]->values.data() + cells, *below = force - stride;
      for (size_t i = 0; i < count; ++i) v[i] += force[i] + below[i];
    });
}

namespace {

// What holds a component of the velocity: solid faces, and the sides.
template <class T>
struct Holds {
  const Lattice<T>* shares;  // open ones; none where nothing is solid
  size_t axis;
  OpenSides open;
  std::array<bool, 6> along;  // sides that hold what flows along them
  std::array<T, 6> value;     // at what

  bool face(size_t face, const std::array<size_t, 3>& at, const std::array<size_t, 3>& n) const {
    if ((at[axis] == 0 && !open[2 * axis]) || (at[axis] + 1 == n[axis] && !open[2 * axis + 1])) return true;
    return shares && shares->values[face] < T(0.5);  // its middle is inside of the solid
  }
};

// out = (I - r lap) x over the faces that move; r = viscosity dt / h^2. Sides that hold the flow are half a cell away; with `still` they
// do at 0. Beyond the others lies the same value.
template <class T>
void friction(const Holds<T>& holds, bool still, T r, const Lattice<T>& x, Lattice<T>& out, const Context& context) {
  const size_t n = x.n[0];
  parallel_for(
      x.rows(), force_rows,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) {
          const std::array<size_t, 3> at{0, row % x.n[1], row / x.n[1]};
          const T* const here = x.row(row);
          T* const to = out.row(row);
          const T *around[4], *const *const last = around + 4;
          const T** next = around;
          T walls = 0, pull = 0;  // of sides that hold the row
          for (size_t a = 1, stride = n; a < 3; stride *= x.n[a++])
            for (size_t side = 0; side < 2; ++side) {
              const bool inside = side == 0 ? at[a] > 0 : at[a] + 1 < x.n[a];
              if (inside) *next++ = side == 0 ? here - stride : here + stride;
              else if (a != holds.axis && holds.along[2 * a + side]) walls += 2, pull += still ? T(0) : 2 * holds.value[2 * a + side];
            }
          const T neighbours = T(next - around);
          while (next != last) *next++ = nullptr;
          const auto value_at = [&](size_t i) {
            T sum = (neighbours + walls) * here[i] - pull;
            for (const T* const line : around)
              if (line) sum -= line[i];
            const auto beyond = [&](size_t side) {
              if (holds.axis != 0 && holds.along[side]) sum += 2 * (here[i] - (still ? T(0) : holds.value[side]));
            };
            if (i > 0) sum += here[i] - here[i - 1];
            else beyond(0);
            if (i + 1 < n) sum += here[i] - here[i + 1];
            else beyond(1);
            return here[i] + r * sum;
          };
          if (next - around == 4 && neighbours == 4 && !holds.shares && !holds.face(row * n + 1, {1, at[1], at[2]}, x.n)) {
            to[0] = holds.face(row * n, at, x.n) ? here[0] : value_at(0);
            const T *const a = around[0], *const b = around[1], *const c = around[2], *const d = around[3];
            for (size_t i = 1; i + 1 < n; ++i)
              to[i] = here[i] + r * (6 * here[i] - ((here[i - 1] + here[i + 1]) + (a[i] + b[i]) + (c[i] + d[i])));
            to[n - 1] = holds.face(row * n + n - 1, {n - 1, at[1], at[2]}, x.n) ? here[n - 1] : value_at(n - 1);
            continue;
          }
          for (size_t i = 0; i < n; ++i) to[i] = holds.face(i + row * n, {i, at[1], at[2]}, x.n) ? here[i] : value_at(i);
        }
      },
      &context);
}

}  // namespace

template <class T>
void diffuse_velocity(const MacGrid& g, const Walls<T>& walls, const Sides& sides, double viscosity, double dt, Faces<T>& u, Spare<T> spare,
                      const Context& context) {
  if (viscosity == 0) return;
  const T r = T(viscosity * dt / (g.h * g.h));
  const double tolerance = std::is_same_v<T, float> ? 1e-6 : 1e-12;
  for (int axis = 0; axis < g.axes(); ++axis) {
    const size_t a = size_t(axis);
    Lattice<T>& x = u[a];
    Holds<T> holds{walls.obstacles() ? &walls.open[a] : nullptr, a, walls.sides, {}, {}};
    for (size_t s = 0; s < 6; ++s) holds.along[s] = int(s / 2) < g.axes() && sides[s].holds(), holds.value[s] = T(sides[s].velocity[axis]);
    // Held faces have their values from now on.
    for (size_t row = 0; row < x.rows(); ++row)
      for (size_t i = 0; i < x.n[0]; ++i) {
        const std::array<size_t, 3> at{i, row % x.n[1], row / x.n[1]};
        const size_t here = i + row * x.n[0];
        if (!holds.face(here, at, x.n)) continue;
        if (at[a] == 0 && !walls.sides[2 * a]) x.values[here] = walls.through[2 * a];
        else if (at[a] + 1 == x.n[a] && !walls.sides[2 * a + 1]) x.values[here] = walls.through[2 * a + 1];
        else x.values[here] = walls.move() ? walls.solid[a].values[here] : T(0);
      }
    Lattice<T>&residual = shaped(spare[0], x.n), &q = shaped(spare[1], x.n), &s = shaped(spare[2], x.n);
    // Conjugate gradients; the values before are a good beginning.
    friction(holds, false, r, x, q, context);
    for (size_t i = 0; i < q.values.size(); ++i) residual.values[i] = x.values[i] - q.values[i];
    s.values = residual.values;
    double rr = dot(residual, residual, context);
    const double enough = tolerance * tolerance * std::max(dot(x, x, context), rr);
    for (int step = 0; step < 1000 && rr > enough; ++step) {
      friction(holds, true, r, s, q, context);
      const T alpha = T(rr / dot(s, q, context));
      for (size_t i = 0; i < q.values.size(); ++i) x.values[i] += alpha * s.values[i], residual.values[i] -= alpha * q.values[i];
      const double next = dot(residual, residual, context);
      const T beta = T(next / rr);
      rr = next;
      for (size_t i = 0; i < q.values.size(); ++i) s.values[i] = residual.values[i] + beta * s.values[i];
    }
  }
}

template void add_buoyancy(const MacGrid&, const OpenSides&, const Lattice<float>&, const Lattice<float>&, Vec3, double, double, double,
                           Faces<float>&, const Context&);
template void add_buoyancy(const MacGrid&, const OpenSides&, const Lattice<double>&, const Lattice<double>&, Vec3, double, double, double,
                           Faces<double>&, const Context&);
template void confine_vortices(const MacGrid&, double, double, Faces<float>&, Spare<float>, const Context&);
template void confine_vortices(const MacGrid&, double, double, Faces<double>&, Spare<double>, const Context&);
template void diffuse_velocity(const MacGrid&, const Walls<float>&, const Sides&, double, double, Faces<float>&, Spare<float>,
                               const Context&);
template void diffuse_velocity(const MacGrid&, const Walls<double>&, const Sides&, double, double, Faces<double>&, Spare<double>,
                               const Context&);

}  // namespace sg::fluid
