// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/poisson.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "simulate/pde/expressions.h"
#include "simulate/pde/march.h"

namespace sg {

namespace {

void describe_problem(Schema& s, PoissonParams& p) {
  describe(s, static_cast<pde::RoomParams&>(p));
  s("source", p.source, "s in -lap u = s: an expression of x, y and z; 0: Laplace's equation.");
  s("tolerance", p.tolerance, "Residual at which to stop, as a share of the right side.").range(1e-15, 1);
  s("iterations", p.iterations, "Iterations at most.").range(0, 1000000);
  s("omega", p.omega, "Over-relaxation of sor; default: the best for the box, 2 / (1 + sqrt(1 - rho^2)).").range(0, 2);
}

struct Solved {
  pde::Values u;
  pde::SolveHistory history;
};

Solved solve_poisson(const PoissonParams& p, const pde::Room& room, const pde::SideValues& sides, const pde::Values& source,
                     pde::Solver solver, const Context& context) {
  pde::Values b = source;
  sides.add_to(b, 1);
  Solved s{pde::Values(room.n()), {}};
  pde::LinearSolver linear({room.axes, 0, 1}, {solver, p.tolerance, p.iterations, p.omega}, "poisson");
  s.history = linear.solve(b, s.u, context);
  return s;
}

}  // namespace

void describe(Schema& s, PoissonParams& p) {
  describe_problem(s, p);
  s("solver", p.solver,
    "jacobi; gauss_seidel and sor in two colours; cg: conjugate gradients; multigrid: V-cycles. poisson_convergence compares them.");
}

void describe(Schema& s, PoissonConvergenceParams& p) {
  describe_problem(s, p);
  s("log", p.log, "The decimal logarithms of the residuals, for curves.");
}

namespace {

// Iterations, of which docs/simulation/pdes.md has a table, and what they take of each unknown.
double seconds_of(const PoissonParams& p, const pde::Room& room, pde::Solver solver) {
  const double n = double(std::max({room.axes[0].n, room.axes[1].n, room.axes[2].n}));
  double iterations = 0, each = 2e-9;
  switch (solver) {
    case pde::Solver::jacobi: iterations = 3.7 * n * n; break;
    case pde::Solver::gauss_seidel: iterations = 1.9 * n * n; break;
    case pde::Solver::sor: iterations = 4.2 * n; break;
    case pde::Solver::cg: iterations = 1.9 * n, each = 4e-9; break;
    case pde::Solver::multigrid: iterations = room.axes[2].flat() ? 9 : 14, each = 4e-8; break;
  }
  return std::min(iterations, double(p.iterations)) * each * double(room.count());
}

}  // namespace

RunCost cost_of_poisson(const PoissonParams& p) {
  const pde::Room room = pde::make_room(p, "poisson", 60, false, Context());
  return {room.count() * (p.type == FieldType::f64 ? 8 : 4), seconds_of(p, room, p.solver)};
}

RunCost cost_of_poisson_convergence(const PoissonConvergenceParams& p) {
  const pde::Room room = pde::make_room(p, "poisson_convergence", 60, false, Context());
  RunCost cost;
  for (const auto& word : enum_words(pde::Solver{})) {
    cost.seconds += seconds_of(p, room, word.value);
    cost.bytes += uint64_t(p.iterations) * sizeof(double);
  }
  return cost;
}

DatasetPtr poisson(const PoissonParams& p, Context& context) {
  const pde::Room room = pde::make_room(p, "poisson", 60, false, context);
  const pde::SideValues sides(room, "poisson", 0, context);
  const pde::Values source = pde::values_of(p.source, room.grid(), 0, "poisson source", context);
  Solved s = solve_poisson(p, room, sides, source, p.solver, context);
  if (std::abs(s.history.taken) > 1e-12)
    context.info(fmt::format("poisson: the mean of the source, {:.3g}, was taken away: nothing passes the sides", s.history.taken));
  if (!s.history.reached)
    context.warn(fmt::format("poisson: the residual is {:.3g} after {} iterations", s.history.residuals.back(), p.iterations));
  DatasetPtr d = pde::room_dataset(room, 0, {pde::whole_field(room, s.u, sides, "potential", p.type, context)});
  DatasetParts parts = d->parts();
  parts.time = {};
  parts.fields.add({"residual", Association::whole, Array::from_vector(std::move(s.history.residuals)), "", Role::none});
  return make_dataset(std::move(parts));
}

TablePtr poisson_convergence(const PoissonConvergenceParams& p, Context& context) {
  const pde::Room room = pde::make_room(p, "poisson_convergence", 60, false, context);
  const pde::SideValues sides(room, "poisson_convergence", 0, context);
  const pde::Values source = pde::values_of(p.source, room.grid(), 0, "poisson_convergence source", context);
  std::vector<std::vector<double>> columns;
  size_t rows = 0;
  for (const auto& word : enum_words(pde::Solver{})) {
    columns.push_back(solve_poisson(p, room, sides, source, word.value, context).history.residuals);
    if (p.log)
      for (double& r : columns.back()) r = r > 0 ? std::log10(r) : std::nan("");
    rows = std::max(rows, columns.back().size());
  }
  Table table;
  std::vector<double> iteration(rows);
  for (size_t i = 0; i < rows; ++i) iteration[i] = double(i);
  table.columns.push_back({"iteration", Association::whole, Array::from_vector(std::move(iteration)), "", Role::none});
  size_t at = 0;
  for (const auto& word : enum_words(pde::Solver{})) {
    columns[at].resize(rows, std::nan(""));
    table.columns.push_back({std::string(word.word), Association::whole, Array::from_vector(std::move(columns[at++])), "", Role::none});
  }
  return std::make_shared<const Table>(std::move(table));
}

}  // namespace sg
