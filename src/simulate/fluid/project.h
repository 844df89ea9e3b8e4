// SPDX-License-Identifier: Apache-2.0
// A flow made free of divergence (Chorin 1968).
#pragma once
#include "simulate/fluid/pressure.h"

namespace sg::fluid {

/// Walls, and the solver that keeps the flow between them free of divergence.
template <class T>
class Projection {
 public:
  /// `open`: share of each face that is not solid, those of the border included; see multigrid.h.
  Projection(const MacGrid& grid, Faces<T> open, const OpenSides& sides);

  /// u becomes u - grad p, with the p for which no more flows into a cell than out: sum over its faces of share * u = 0, to `tolerance`
  /// times the largest such sum before. Through solid faces and closed sides nothing flows. `p` (per cell, length * velocity) begins as
  /// what it was and ends as the solution. Throws as PressureSolver::solve().
  SolveReport apply(Faces<T>& u, Lattice<T>& p, double tolerance, const Context& context);
  /// Flow out of each cell, as a share of its faces' area: h div u.
  void divergence(const Faces<T>& u, Lattice<T>& out, const Context& context) const;
  /// Share of a face that is open.
  const Faces<T>& open() const { return open_; }

 private:
  MacGrid grid_;
  Faces<T> open_;
  OpenSides sides_;
  PressureSolver<T> solver_;
  Lattice<T> b_;
};

}  // namespace sg::fluid
