// SPDX-License-Identifier: Apache-2.0
// Modes of a line between two sides, and norms, for the tests of partial differential equations.
#pragma once
#include <cmath>
#include <numbers>
#include <string>

#include "simulate/pde/room.h"

namespace sg::test {

using std::numbers::pi;

/// A line, square or cube of unit sides.
inline std::vector<double> unit_box(int axes) { return {0, 1, 0, axes > 1 ? 1.0 : 0.0, 0, axes > 2 ? 1.0 : 0.0}; }

/// The largest difference to f(place).
template <class F>
double largest_error(const pde::Room& room, const pde::Values& u, F&& f) {
  const UniformGrid g = room.grid();
  double worst = 0;
  for (size_t i = 0; i < u.values.size(); ++i) {
    const Vec3 at = g.origin + g.spacing * Vec3(double(i % u.n[0]), double(i / u.n[0] % u.n[1]), double(i / (u.n[0] * u.n[1])));
    worst = std::max(worst, std::abs(u.values[i] - f(at)));
  }
  return worst;
}

}  // namespace sg::test
