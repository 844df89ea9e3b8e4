// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/solvers.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/text/text.h"
#include "simulate/fluid/lattice_sums.h"

namespace sg::pde {

namespace {

// to[i] = f(i)
template <class F>
void each_value(Values& to, const Context& context, F&& f) {
  parallel_for(
      to.values.size(), fluid::values_at_once,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) to.values[i] = f(i);
      },
      &context);
}

double total(const Values& v, bool sizes, const Context& context) {
  return parallel_reduce(
      v.values.size(), fluid::values_at_once, 0.0,
      [&](size_t begin, size_t end) {
        double s = 0;
        for (size_t i = begin; i < end; ++i) s += sizes ? std::abs(v.values[i]) : v.values[i];
        return s;
      },
      [](double a, double b) { return a + b; }, &context);
}

void take_mean(Values& v, const Context& context) {
  const double mean = total(v, false, context) / double(v.values.size());
  for (double& x : v.values) x -= mean;
}

}  // namespace

LinearSolver::LinearSolver(Operator op, SolveOptions options, std::string who)
    : op_(std::move(op)), options_(options), who_(std::move(who)), r_(op_.n()) {
  if (options_.solver == Solver::multigrid) multigrid_ = std::make_unique<Multigrid>(op_);
  if (options_.solver == Solver::cg) s_ = z_ = Values(op_.n());
}

LinearSolver::~LinearSolver() = default;

SolveHistory LinearSolver::solve(Values& b, Values& x, const Context& context) {
  SolveHistory history;
  const bool singular = op_.singular();
  if (singular) {
    const double sum = total(b, false, context), size = total(b, true, context);
    if (std::abs(sum) > 0.01 * size)
      fail_data(fmt::format("there is no solution: nothing passes the sides, yet the source has a mean of {}",
                            exact_number(sum / double(b.values.size()))),
                who_, "hold the value at a side, such as x0=0, or give a source of mean 0");
    history.taken = sum / double(b.values.size());
    for (double& v : b.values) v -= history.taken;
  }
  const double size = std::sqrt(fluid::dot(b, b, context));
  if (size == 0) {
    std::fill(x.values.begin(), x.values.end(), 0.0);
    history.residuals = {0}, history.reached = true;
    return history;
  }
  const double omega = options_.solver == Solver::sor ? options_.omega.value_or(op_.best_omega()) : 1;
  double rr = 0;
  bool stuck = false;
  op_.residual(b, x, r_, context);
  for (int done = 0; !stuck; ++done) {
    const double now = fluid::dot(r_, r_, context), share = std::sqrt(now) / size;
    if (!std::isfinite(share))
      fail_data(fmt::format("the residual grew beyond all numbers after {} iterations", done), who_, "another solver or omega converges");
    history.residuals.push_back(share);
    history.reached = share <= options_.tolerance;
    if (history.reached || done == options_.iterations) break;
    switch (options_.solver) {
      case Solver::jacobi:
        each_place<1>(op_.axes, x, 0, context, [&](size_t i, double, double diagonal) {
          const double d = op_.shift + op_.scale * diagonal;
          r_.values[i] = d > 0 ? r_.values[i] / d : 0;
        });
        each_value(x, context, [&](size_t i) { return x.values[i] + r_.values[i]; });
        break;
      case Solver::gauss_seidel:
      case Solver::sor: op_.relax(b, x, 0, omega, context), op_.relax(b, x, 1, omega, context); break;
      case Solver::multigrid: multigrid_->cycle(b, x, context); break;
      case Solver::cg: {  // Hestenes, Stiefel 1952
        const double beta = done == 0 ? 0 : now / rr;
        rr = now;
        each_value(s_, context, [&](size_t i) { return r_.values[i] + beta * s_.values[i]; });
        op_.apply(s_, z_, context);
        const double curvature = fluid::dot(s_, z_, context);
        if (!(curvature > 0)) {  // nothing is left but rounding
          stuck = true;
          continue;
        }
        const double alpha = rr / curvature;
        each_value(x, context, [&](size_t i) { return x.values[i] + alpha * s_.values[i]; });
        each_value(r_, context, [&](size_t i) { return r_.values[i] - alpha * z_.values[i]; });
        continue;
      }
    }
    op_.residual(b, x, r_, context);
  }
  if (singular) take_mean(x, context);
  return history;
}

}  // namespace sg::pde
