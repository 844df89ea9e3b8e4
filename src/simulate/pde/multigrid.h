// SPDX-License-Identifier: Apache-2.0
// shift x - scale lap x in a room, and a multigrid cycle that nearly inverts it.
#pragma once
#include <vector>

#include "simulate/pde/stencil.h"

namespace sg::pde {

/// A = shift - scale lap, with 0 on the walls: symmetric, positive semidefinite for shift, scale >= 0; singular where shift is 0 and no
/// wall is near.
struct Operator {
  std::array<Axis, 3> axes;
  double shift = 0, scale = 1;

  std::array<size_t, 3> n() const { return {axes[0].n, axes[1].n, axes[2].n}; }
  bool singular() const;
  void apply(const Values& x, Values& out, const Context& context) const;
  void residual(const Values& b, const Values& x, Values& r, const Context& context) const;
  /// Places of one colour take x + omega (what solves their equation - x): 1 is Gauss-Seidel, above it successive over-relaxation.
  void relax(const Values& b, Values& x, int color, double omega, const Context& context) const;
  /// The omega with which relaxation in two colours converges fastest: 2 / (1 + sqrt(1 - rho^2)), rho of Jacobi's iteration (Young 1954).
  double best_omega() const;
};

/// A symmetric V-cycle (Trottenberg, Oosterlee, Schueller 2001): Gauss-Seidel in two colours before, in the reverse order after, linear
/// interpolation between the places of a grid of half as many unknowns in the same box, and its transpose for residuals. Sizes need not
/// be powers of two; long cells are halved first.
class Multigrid {
 public:
  explicit Multigrid(Operator op);
  /// One cycle from the values of x on.
  void cycle(const Values& b, Values& x, const Context& context) { cycle(0, b, x, context); }
  size_t levels() const { return levels_.size(); }

 private:
  struct Mix {  // a fine place between two coarse ones
    size_t from[2] = {0, 0};
    double weight[2] = {0, 0};
  };
  struct Level {
    Operator op;
    std::array<std::vector<Mix>, 3> mixes;  ///< to the next level; empty along axes that stay
    std::array<double, 3> shares{1, 1, 1};  ///< of a coarse place's length in that of a fine one
    Values x, b, r;
    std::vector<Values> between;  ///< partly coarsened
  };
  static std::vector<Mix> mixes_of(const Axis& fine, const Axis& coarse);
  void cycle(size_t level, const Values& b, Values& x, const Context& context);
  void restrict_to(Level& fine, Values& coarse, const Context& context);
  void add_prolonged(Level& fine, const Values& coarse, Values& x, const Context& context);
  std::vector<Level> levels_;
};

}  // namespace sg::pde
