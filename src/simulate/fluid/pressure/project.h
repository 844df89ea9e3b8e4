// SPDX-License-Identifier: Apache-2.0
// A flow made free of divergence (Chorin 1968).
#pragma once
#include "simulate/fluid/pressure/pressure.h"

namespace sg::fluid {

/// Walls, and the solver that keeps the flow between them free of divergence.
template <class T>
class Projection {
 public:
  Projection(const MacGrid& grid, Walls<T> walls);

  /// u becomes u - grad p, with the p for which no more flows into a cell than out: sum over its faces of share * u = 0, to `tolerance`
  /// times the largest such sum before. Through solid faces and closed sides nothing flows. `p` (per cell, length * velocity) begins as
  /// what it was and ends as the solution. `spare`: five lattices. Throws as PressureSolver::solve().
  SolveReport apply(Faces<T>& u, Lattice<T>& p, double tolerance, Spare<T> spare, const Context& context);
  /// Flow out of each cell, as a share of its faces' area: h div u, with what sides and moving solids push through its faces.
  void divergence(const Faces<T>& u, Lattice<T>& out, const Context& context) const;
  const Walls<T>& walls() const { return solver_.walls(); }
  /// Cells of air, one byte each, in which the pressure is 0 and the flow does as it likes.
  void set_air(std::vector<uint8_t> air);

 private:
  void add_solid_flow(size_t row, T* to) const;
  void subtract_gradient(size_t axis, const Lattice<T>& p, Lattice<T>& v, const Context& context) const;

  MacGrid grid_;
  PressureSolver<T> solver_;
  std::vector<uint8_t> air_;
};

}  // namespace sg::fluid
