// SPDX-License-Identifier: Apache-2.0
// The fit of one diffusion tensor to the signals of one place.
#pragma once
#include <span>

#include "filter/tensor/diffusion/gradient_table.h"
#include "filter/tensor/sym_tensor.h"

namespace sg {

enum class DiffusionFit : uint8_t { linear, weighted, positive };
constexpr auto enum_words(DiffusionFit) {
  using enum DiffusionFit;
  return std::array{Word{"linear", linear}, Word{"weighted", weighted}, Word{"positive", positive}};
}

struct DiffusionResult {
  SymTensor d{NAN, NAN, NAN, NAN, NAN, NAN};  ///< mm^2/s
  double s0 = NAN;                            ///< signal without gradient
  double residual = NAN;                      ///< root mean square of signal less model, in units of the signal
  bool raised = false;                        ///< the unconstrained tensor was not positive
};

/// Stejskal, Tanner 1965: ln S_i = ln S0 - b_i g_i^T D g_i (Basser, Mattiello, Le Bihan 1994).
class DiffusionModel {
 public:
  /// Throws Error(usage) when the gradients do not determine the seven unknowns: fewer than six directions in general position, or a single
  /// b without a volume of another b.
  explicit DiffusionModel(const GradientTable& gradients);

  /// linear: least squares of the logarithms, by a QR factorisation, exact for signals without noise. weighted: each logarithm counts with
  /// the square of the signal that the fit before predicts (Salvador et al. 2005), two rounds. positive: weighted, and where an
  /// eigenvalue is not above zero D = L L^T with a lower triangular L is fitted to the same weighted logarithms by Levenberg-Marquardt
  /// (Koay et al. 2006), so that all eigenvalues are 0 or more. Signals of 0 and below have no logarithm and are left out; NaN and
  /// fewer than seven useful ones give NaN. Not thread-safe: one copy per thread.
  DiffusionResult fit(std::span<const double> signal, DiffusionFit method);

 private:
  bool solve(const double* weight, double* x);
  double cost(const double* l) const;
  void fit_positive(double* x);
  size_t n_ = 0;
  double scale_ = 1;             // largest b: unknowns are D * scale
  std::vector<double> rows_;     // 7 a volume
  std::vector<double> inverse_;  // 7 x n: all unknowns from all logarithms
  std::vector<double> log_, weight_, work_, right_;
};

}  // namespace sg
