// SPDX-License-Identifier: Apache-2.0
// The equations of motion of a Lagrangian L(q, q'), by automatic differentiation, and steps in time.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "simulate/mechanics/system.h"
#include "simulate/run/integrator.h"

namespace sg::mechanics {

using Numbers = std::vector<double>;

/// Coordinates and momenta p = dL/dq'.
struct State {
  Numbers q, p;
};

/// Not for several threads at once: it keeps its tape.
class Motion {
 public:
  explicit Motion(std::shared_ptr<const System> system);
  const System& system() const { return *system_; }

  /// Of these coordinates and speeds. Throws Error(usage), naming a coordinate, where the mass matrix is singular.
  State state(const Numbers& q, const Numbers& v);
  /// M_ij = d2L/dq'_i dq'_j, row by row.
  Numbers mass_matrix(const Numbers& q, const Numbers& v);
  /// q'' of M q'' = dL/dq - (d2L/dq'dq) q' (Euler, Lagrange). Throws Error(usage) for singular M.
  Numbers acceleration(const Numbers& q, const Numbers& v);
  /// q' of a state.
  Numbers speed(const State& s);
  /// From where Newton's method begins: a state goes on to the same bytes only from the same one.
  Numbers& guess() { return last_speed_; }
  /// Kinetic and potential energy.
  std::array<double, 2> energies(const State& s);

  /// A step of length h. In q and p, where Hamilton's equations are q' = v(q, p) and p' = dL/dq: symplectic_euler and verlet are symplectic
  /// for every Lagrangian, also where masses depend on coordinates (Hairer, Lubich, Wanner: Geometric Numerical Integration, VI.3). What is
  /// implicit is solved by Newton's method with exact derivatives. Throws Error(data) where that finds nothing.
  void step(Integrator scheme, double h, State& s);

 private:
  // First derivatives of L at (q, v), and their derivatives along directions of (q, v): columns of n numbers.
  struct Slopes {
    Numbers by_q, by_v;
    std::vector<Numbers> by_q_along, by_v_along;
  };
  struct Direction {
    Numbers q, v;
  };
  Slopes slopes(const Numbers& q, const Numbers& v, const std::vector<Direction>& directions);
  Numbers solve_momenta(const Numbers& base, double alpha, double beta, const Numbers& rhs, Numbers guess);

  std::shared_ptr<const System> system_;
  autodiff::Tape<Along> tape_;
  Numbers last_speed_;
};

}  // namespace sg::mechanics
