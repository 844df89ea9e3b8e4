// SPDX-License-Identifier: Apache-2.0
// Poisson's and Laplace's equation in a box: -lap u = s, by solvers that can be compared.
#pragma once
#include <string>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"
#include "simulate/pde/room.h"
#include "simulate/pde/solvers.h"
#include "simulate/run/frames.h"

namespace sg {

struct PoissonParams : pde::RoomParams {
  PoissonParams() { sides = "0"; }
  std::string source = "1";
  pde::Solver solver = pde::Solver::multigrid;
  double tolerance = 1e-8;
  int iterations = 10000;
  std::optional<double> omega;
};
void describe(Schema& s, PoissonParams& p);

/// Point field potential, and of the whole dataset the field residual: |s + lap u| / |s| before and after each iteration, walls counted
/// as sources. Where nothing holds the value (all sides insulated or periodic) the source must have the mean 0 and the potential gets it;
/// Error(data) otherwise. A warning says where the tolerance is not reached.
DatasetPtr poisson(const PoissonParams& p, Context& context);

struct PoissonConvergenceParams : PoissonParams {
  PoissonConvergenceParams() { iterations = 200; }
  bool log = false;
};
void describe(Schema& s, PoissonConvergenceParams& p);

/// A table: iteration, and the residual of each solver after it (log: its log10); NaN once it is below the tolerance.
TablePtr poisson_convergence(const PoissonConvergenceParams& p, Context& context);

/// With held sides; without any it may take longer.
RunCost cost_of_poisson(const PoissonParams& p);
RunCost cost_of_poisson_convergence(const PoissonConvergenceParams& p);

}  // namespace sg
