// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/dust/drag_exchange.h"

#include <algorithm>
#include <array>
#include <type_traits>

#include "base/parallel.h"

namespace sg::fluid {

namespace {

constexpr size_t dust_grain = 2048, face_grain = 1 << 14;

template <class Number>
Vec3 read(const MacGrid& g, const Faces<Number>& u, const Vec3& x) {
  Vec3 v;
  for (int a = 0; a < g.axes(); ++a) {
    const Lattice<Number>& l = u[size_t(a)];
    Corners(l.n, a, x).each([&](const std::array<size_t, 3>& at, double w, const auto&) { v[a] += w * double(l(at[0], at[1], at[2])); });
  }
  return v;
}

}  // namespace

template <class T>
DragExchange<T>::DragExchange(const MacGrid& g, const DragLaw& law) : grid_(g), law_(law) {
  for (Faces<double>* f : {&x_, &r_, &z_, &d_, &q_, &scale_}) *f = make_faces<double>(g);
}

// Adds weight * amount(p) of each particle to the faces about it.
template <class T>
template <class F>
void DragExchange<T>::spread(const std::vector<DustParticle>& particles, const std::vector<uint32_t>& begin, Faces<double>& to,
                             const Context& context, F&& amount) const {
  each_to_places(grid_, begin, context, [&](size_t p) {
    const Vec3 all = amount(p);
    for (int a = 0; a < grid_.axes(); ++a) {
      Lattice<double>& l = to[size_t(a)];
      Corners(l.n, a, particles[p].x).each([&](const std::array<size_t, 3>& at, double w, const auto&) {
        l(at[0], at[1], at[2]) += w * all[a];
      });
    }
  });
}

// Calls f(axis, face).
template <class T>
template <class F>
void DragExchange<T>::each_free(const Context& context, F&& f) const {
  for (size_t a = 0; a < 3; ++a)
    parallel_for(
        free_[a].size(), face_grain,
        [&](size_t first, size_t last) {
          for (size_t i = first; i < last; ++i) f(a, free_[a][i]);
        },
        &context);
}

template <class T>
double DragExchange<T>::product(const Faces<double>& a, const Faces<double>& b, const Context& context) const {
  double sum = 0;
  for (size_t c = 0; c < 3; ++c)
    sum = parallel_reduce(
        free_[c].size(), face_grain, sum,
        [&](size_t first, size_t last) {
          double s = 0;
          for (size_t i = first; i < last; ++i) s += a[c].values[free_[c][i]] * b[c].values[free_[c][i]];
          return s;
        },
        [](double x, double y) { return x + y; }, &context);
  return sum;
}

template <class T>
void DragExchange<T>::clear(Faces<double>& f, bool held_alone) const {
  for (size_t a = 0; a < 3; ++a) {
    for (const uint32_t i : held_[a]) f[a].values[i] = 0;
    if (!held_alone)
      for (const uint32_t i : free_[a]) f[a].values[i] = 0;
  }
}

template <class T>
void DragExchange<T>::find_faces(const std::vector<DustParticle>& particles, const std::vector<uint32_t>& begin, const Faces<T>& u,
                                 const Walls<T>& walls, double coupling, const Context& context) {
  for (Faces<double>* f : {&r_, &q_, &scale_}) clear(*f);  // of the last step's faces
  spread(particles, begin, scale_, context, [&](size_t) { return coupling * Vec3(1, 1, 1); });
  for (int axis = 0; axis < grid_.axes(); ++axis) {
    const size_t a = size_t(axis);
    free_[a].clear(), held_[a].clear();
    const Lattice<double>& l = scale_[a];
    for (size_t row = 0; row < l.rows(); ++row)
      for (size_t i = 0; i < l.n[0]; ++i) {
        const size_t here = i + row * l.n[0];
        if (l.values[here] == 0) continue;
        const std::array<size_t, 3> at{i, row % l.n[1], row / l.n[1]};
        r_[a].values[here] = q_[a].values[here] = d_[a].values[here] = 0;
        if (walls.share(grid_.cells, axis, at[0], at[1], at[2]) > 0) {
          free_[a].push_back(uint32_t(here)), x_[a].values[here] = double(u[a].values[here]);
          continue;
        }
        held_[a].push_back(uint32_t(here));
        const bool lower = at[a] == 0 && !walls.sides[2 * a], upper = at[a] == grid_.cells[a] && !walls.sides[2 * a + 1];
        x_[a].values[here] = lower || upper ? double(walls.through[2 * a + upper]) : walls.move() ? double(walls.solid[a].values[here]) : 0;
      }
  }
}

// (1 + coupling W'W) x = x before + coupling W' w, W the matrix of the weights, in x_; with the sums of the rows before it.
template <class T>
void DragExchange<T>::solve(const std::vector<DustParticle>& particles, const std::vector<uint32_t>& begin, double coupling,
                            const Context& context) {
  const double tolerance = std::is_same_v<T, float> ? 1e-6 : 1e-12;
  spread(particles, begin, r_, context, [&](size_t p) { return coupling * (before_[p] - read(grid_, x_, particles[p].x)); });
  clear(r_, true);
  const auto precondition = [&](size_t a, size_t i) { z_[a].values[i] = r_[a].values[i] / (1 + scale_[a].values[i]); };
  each_free(context, [&](size_t a, size_t i) { precondition(a, i), d_[a].values[i] = z_[a].values[i]; });
  double rz = product(r_, z_, context);
  const double enough = tolerance * tolerance * rz;
  for (; iterations_ < 200 && rz > enough; ++iterations_) {
    clear(q_);
    spread(particles, begin, q_, context, [&](size_t p) { return coupling * read(grid_, d_, particles[p].x); });
    each_free(context, [&](size_t a, size_t i) { q_[a].values[i] += d_[a].values[i]; });
    const double alpha = rz / product(d_, q_, context);
    each_free(context, [&](size_t a, size_t i) {
      x_[a].values[i] += alpha * d_[a].values[i], r_[a].values[i] -= alpha * q_[a].values[i];
      precondition(a, i);
    });
    const double next = product(r_, z_, context), more = next / rz;
    rz = next;
    each_free(context, [&](size_t a, size_t i) { d_[a].values[i] = z_[a].values[i] + more * d_[a].values[i]; });
  }
}

template <class T>
void DragExchange<T>::exchange(double dt, std::vector<DustParticle>& particles, const std::vector<uint32_t>& begin, Faces<T>& u,
                               const Walls<T>& walls, const Context& context) {
  const double air = air_mass();
  beta_ = dt * law_.drag / law_.mass, iterations_ = 0;
  before_.resize(particles.size());
  for (size_t p = 0; p < particles.size(); ++p) before_[p] = particles[p].v + dt * law_.pull;
  const double coupling = dt * law_.drag / (1 + beta_) / air;
  find_faces(particles, begin, u, walls, coupling, context);
  solve(particles, begin, coupling, context);
  parallel_for(
      particles.size(), dust_grain,
      [&](size_t first, size_t last) {
        for (size_t p = first; p < last; ++p) particles[p].v = (1 / (1 + beta_)) * (before_[p] + beta_ * read(grid_, x_, particles[p].x));
      },
      &context);
  // What the particles gained, the air loses.
  clear(q_);
  spread(particles, begin, q_, context, [&](size_t p) { return (law_.mass / air) * (particles[p].v - before_[p]); });
  each_free(context, [&](size_t a, size_t i) { u[a].values[i] = T(double(u[a].values[i]) - q_[a].values[i]); });
}

template <class T>
void DragExchange<T>::follow(std::vector<DustParticle>& particles, const std::vector<uint32_t>& begin, const Faces<T>& u,
                             Faces<double>& owed, const Context& context) {
  for (Lattice<double>& l : owed) std::fill(l.values.begin(), l.values.end(), 0.0);
  std::vector<Vec3> gained(particles.size());
  parallel_for(
      particles.size(), dust_grain,
      [&](size_t first, size_t last) {
        for (size_t p = first; p < last; ++p) {
          const Vec3 v = (1 / (1 + beta_)) * (before_[p] + beta_ * read(grid_, u, particles[p].x));
          gained[p] = v - particles[p].v, particles[p].v = v;
        }
      },
      &context);
  spread(particles, begin, owed, context, [&](size_t p) { return (law_.mass / air_mass()) * gained[p]; });
  clear(owed, true);
}

template class DragExchange<float>;
template class DragExchange<double>;

}  // namespace sg::fluid
