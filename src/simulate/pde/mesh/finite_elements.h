// SPDX-License-Identifier: Apache-2.0
// Linear finite elements: the stiffness and the lumped mass of a mesh, and conjugate gradients on them.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "simulate/pde/mesh/simplices.h"

namespace sg::pde {

/// (K u)_i = sum over simplices of kappa size grad u . grad N_i: on triangles the Laplacian with cotangent weights (Pinkall, Polthier
/// 1993). K is symmetric, K 1 = 0, and K of a linear function is 0 at points inside. mass: each point's share of the simplices about it.
struct Stiffness {
  std::vector<size_t> begin;     ///< points + 1
  std::vector<uint32_t> column;  ///< ascending in each row, the row itself among them
  std::vector<double> value;
  std::vector<double> diagonal, mass;

  size_t points() const { return mass.size(); }
};

/// `kappa`: one number a simplex, >= 0.
Stiffness stiffness_of(const Simplices& s, const std::vector<double>& kappa, const Context& context);

/// out = shift mass x + scale K x.
void apply(const Stiffness& k, double shift, double scale, const std::vector<double>& x, std::vector<double>& out, const Context& context);

struct FemSolve {
  int iterations = 0;
  double residual = 0;  ///< |b - A x| / |b| at the end, preconditioned
  bool reached = false;
};

/// (shift mass + scale K) x = b at the points that are not held, where x keeps its values: conjugate gradients with the diagonal before
/// them, from x on. Points without cells keep theirs, too.
FemSolve solve(const Stiffness& k, double shift, double scale, const std::vector<double>& b, const std::vector<uint8_t>& held,
               double tolerance, int most, std::vector<double>& x, const Context& context);

}  // namespace sg::pde
