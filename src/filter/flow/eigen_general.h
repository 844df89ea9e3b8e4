// SPDX-License-Identifier: Apache-2.0
// Eigenvalues of a real 3x3 matrix that need not be symmetric: what a velocity gradient is classified by.
#pragma once
#include "base/vec.h"

namespace sg {

/// Either three real eigenvalues, descending, or one real and a pair re +- i im.
struct GeneralEigenvalues {
  bool complex_pair = false;
  double real[3] = {0, 0, 0};  ///< complex_pair: only real[0]
  double re = 0, im = 0;       ///< of the pair, im > 0
};

/// Roots of the characteristic polynomial (trigonometric and hyperbolic forms; Numerical Recipes 5.6), polished by Newton. NaN in, NaN out.
GeneralEigenvalues general_eigenvalues(const Mat3& a);

/// Unit eigenvector of a real eigenvalue: the largest cross product of two rows of a - lambda; any unit vector of the space when it has
/// more than one dimension.
Vec3 eigenvector_of(const Mat3& a, double lambda);

}  // namespace sg
