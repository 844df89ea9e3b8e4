// SPDX-License-Identifier: Apache-2.0
// Ways to solve (shift - scale lap) x = b in a room, with the history of their residuals.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/schema/schema.h"
#include "simulate/pde/multigrid.h"

namespace sg::pde {

enum class Solver { jacobi, gauss_seidel, sor, cg, multigrid };
constexpr auto enum_words(Solver) {
  using enum Solver;
  return std::array{Word{"jacobi", jacobi}, Word{"gauss_seidel", gauss_seidel}, Word{"sor", sor}, Word{"cg", cg},
                    Word{"multigrid", multigrid}};
}

struct SolveOptions {
  Solver solver = Solver::multigrid;
  double tolerance = 1e-8;
  int iterations = 10000;
  std::optional<double> omega = {};  ///< of sor; default: the best
};

struct SolveHistory {
  std::vector<double> residuals;  ///< |b - A x| / |b| (root of the sum of squares): before, and after each iteration
  bool reached = false;
  double taken = 0;  ///< the mean of b that a singular A cannot reach
};

/// A place for the vectors of a solution, so that many right sides may follow one another.
class LinearSolver {
 public:
  LinearSolver(Operator op, SolveOptions options, std::string who);
  ~LinearSolver();
  /// From the values of x on. An A that is singular takes b's mean away and gives an x of mean 0: Error(data) where that mean is more than
  /// a hundredth of b's size, for then there is no solution. Throws Error(data), too, where the values grow beyond all numbers.
  SolveHistory solve(Values& b, Values& x, const Context& context);
  const Operator& op() const { return op_; }

 private:
  Operator op_;
  SolveOptions options_;
  std::string who_;
  std::unique_ptr<Multigrid> multigrid_;
  Values r_, s_, z_;
};

}  // namespace sg::pde
