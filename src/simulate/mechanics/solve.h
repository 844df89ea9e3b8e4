// SPDX-License-Identifier: Apache-2.0
// Small dense linear systems.
#pragma once
#include <vector>

namespace sg::mechanics {

/// Solves A x = b for x, which comes in as b; A is n rows of n. By rows scaled to alike size and partial pivoting. Returns -1, or the
/// number of the unknown at which a pivot is nothing but rounding: A is singular.
int solve(std::vector<double> a, std::vector<double>& b);

}  // namespace sg::mechanics
