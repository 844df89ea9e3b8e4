// SPDX-License-Identifier: Apache-2.0
// Nodal bases are found from their nodes: N(x) = V^-T phi(x), phi products of Legendre polynomials.
#pragma once
#include <cstddef>
#include <utility>
#include <vector>

namespace sg::mfem {

/// P_n and its derivative at x in [-1, 1].
std::pair<double, double> legendre(int n, double x);

/// Solves a x = b for `columns` right sides at once (row-major, in place); a (n x n) is destroyed. Error(internal) where it is singular.
void solve(std::vector<double>& a, std::vector<double>& b, size_t n, size_t columns);

}  // namespace sg::mfem
