// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/advection/advect.h"

#include <vector>

#include "base/parallel.h"
#include "simulate/fluid/advection/carry.h"
#include "simulate/fluid/advection/place_velocity.h"

namespace sg::fluid {

namespace {

constexpr size_t place_rows = 8;

// f - dt u . grad f; beyond the border the value at it.
template <class T>
void central_rows(const Carrier<T>& step, int axis, const Lattice<T>& f, Lattice<T>& out, size_t begin, size_t end) {
  const size_t stride[3] = {1, f.n[0], f.n[0] * f.n[1]};
  const T courant = T(step.dt / step.grid.h);
  std::vector<T> velocities(3 * f.n[0]);
  T* const u[3] = {velocities.data(), velocities.data() + f.n[0], velocities.data() + 2 * f.n[0]};
  for (size_t row = begin; row < end; ++row) {
    place_velocities(step.grid, step.velocity, axis, row, u);
    for (size_t i = 0; i < f.n[0]; ++i) {
      const std::array<size_t, 3> place{i, row % f.n[1], row / f.n[1]};
      const size_t at = i + row * f.n[0];
      T change = 0;
      for (size_t a = 0; a < 3; ++a) {
        const T before = f.values[place[a] > 0 ? at - stride[a] : at], after = f.values[place[a] + 1 < f.n[a] ? at + stride[a] : at];
        change += courant * u[a][i] * (after - before) / 2;
      }
      out.values[at] = f.values[at] - change;
    }
  }
}

}  // namespace

template <class T>
void advect(const Carrier<T>& step, int axis, std::span<const Carried<T>> fields, Lattice<T>& marks, const Context& context) {
  const size_t rows = fields.front().f->rows();
  if (step.scheme == Advection::explicit_euler) {
    for (const Carried<T>& c : fields)
      parallel_for(
          rows, place_rows, [&](size_t begin, size_t end) { central_rows(step, axis, *c.f, *c.out, begin, end); }, &context);
    return;
  }
  const auto carry = [&](Pass pass) {
    parallel_for(
        rows, place_rows, [&](size_t begin, size_t end) { carry_rows(step, axis, pass, fields, marks, begin, end); }, &context);
  };
  switch (step.scheme) {
    case Advection::explicit_euler: break;
    case Advection::semi_lagrangian: carry(Pass::back); break;
    case Advection::maccormack: carry(Pass::back_marked), carry(Pass::correct); break;
    case Advection::bfecc: carry(Pass::back), carry(Pass::compensate), carry(Pass::back_limited); break;
  }
}

template void advect(const Carrier<float>&, int, std::span<const Carried<float>>, Lattice<float>&, const Context&);
template void advect(const Carrier<double>&, int, std::span<const Carried<double>>, Lattice<double>&, const Context&);

}  // namespace sg::fluid
