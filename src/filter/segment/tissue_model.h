// SPDX-License-Identifier: Apache-2.0
// The mixture that classify fits: pure classes, mixes of neighbours in intensity, and a log-polynomial bias.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "base/context.h"
#include "base/vec.h"

namespace sg {

/// exp(sum over terms of coefficient * P_i(x) P_j(y) P_k(z)), Legendre polynomials of total degree 1..degree on [-1,1]^3.
struct BiasPolynomial {
  int degree = 0;
  std::vector<std::array<int, 3>> terms;  ///< by rising total degree
  std::vector<double> coefficient;
  double log_scale = 0;  ///< added to the exponent

  BiasPolynomial() = default;
  /// Axes with one sample have no terms.
  BiasPolynomial(int degree, const std::array<bool, 3>& axes);
  /// Values of all terms at a place of [-1,1]^3.
  void basis(Vec3 at, double* values) const;
  double log_value(const double* values) const;
  /// Number of terms of total degree <= d.
  size_t terms_up_to(int d) const;
};
/// P_0(x) ... P_degree(x).
void legendre(double x, int degree, double* p);

struct TissueModel {
  std::vector<double> mean, deviation;  ///< of the pure classes, ascending
  std::vector<double> share;            ///< of the pure classes, then of the mixes k|k+1
  BiasPolynomial bias;
  bool background = false;  ///< the first class is nothing: pure noise, which the bias does not affect
  int iterations = 0;
  bool converged = false;
  double log_likelihood = 0;  ///< mean per sample

  size_t pure() const { return mean.size(); }
  size_t parts() const { return share.size(); }
};

/// Density of every part at an intensity where the bias is `factor`, without its share; the expected proportion of the brighter class in
/// each mix.
void part_densities(const TissueModel& m, double y, double factor, double* density, double* proportion);

struct TissueSamples {
  std::vector<double> value;
  std::vector<double> basis;  ///< terms per sample
};

struct FitOptions {
  double least_deviation = 0;
  int iterations = 200;
  double tolerance = 1e-5;
  bool with_bias = true;  ///< else the bias stays as it is
};
/// Expectation-maximisation from a start model (means, deviations, shares given). The degree of the bias rises during the first rounds.
void fit_tissues(TissueModel& model, const TissueSamples& samples, const FitOptions& options, const Context& context);

}  // namespace sg
