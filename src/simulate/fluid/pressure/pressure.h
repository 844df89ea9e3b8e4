// SPDX-License-Identifier: Apache-2.0
// The pressure that makes a flow free of divergence: conjugate gradients with multigrid before them.
#pragma once
#include <cstdint>
#include <vector>

#include "simulate/fluid/pressure/multigrid.h"

namespace sg::fluid {

struct SolveReport {
  int iterations = 0;
  double residual = 0;  ///< the largest |b - A p| as a share of the largest |b|
};

/// Solves A p = b for the A of multigrid.h. Every room without an opening determines its pressure up to a constant: there the mean of b is
/// taken away, and that of p is 0. Sums are the same for any number of threads.
template <class T>
class PressureSolver {
 public:
  PressureSolver(std::array<size_t, 3> cells, Walls<T> walls);

  /// From the values of p on, until the residual is at most `tolerance`, or `most` iterations are done. Throws Error(data) where b adds up
  /// to something in a closed room: what flows in cannot flow out; and where no progress is made. `spare`: four lattices.
  SolveReport solve(Lattice<T>& b, Lattice<T>& p, double tolerance, Spare<T> spare, const Context& context, int most = 200);
  const Walls<T>& walls() const { return multigrid_.walls(); }
  /// Cells of air, see Multigrid::set_air().
  void set_air(std::vector<uint8_t> air);
  /// Rooms that have no opening, neither to the outside nor to air.
  size_t closed_rooms() const { return closed_; }

 private:
  void find_rooms(const std::vector<uint8_t>& air);
  void balance(Lattice<T>& v, bool must) const;

  std::array<size_t, 3> cells_;
  Multigrid<T> multigrid_;
  std::vector<int32_t> room_;  // of each cell, from 0 on; -1: dry, or a room with an opening
  size_t closed_ = 0;
};

}  // namespace sg::fluid
