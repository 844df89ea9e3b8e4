// SPDX-License-Identifier: Apache-2.0
// Where a tensor that is linear over a triangle has two equal eigenvalues.
#pragma once
#include <vector>

#include "filter/tensor/sym_tensor.h"

namespace sg {

/// A place in the triangle a b c.
struct DegeneratePlace {
  double s = 0, t = 0;         ///< a + s (b - a) + t (c - a)
  bool planar = false;         ///< the larger two are equal (disc-like); else the smaller two (line-like)
  double twice = 0, once = 0;  ///< the double eigenvalue and the other one
  Vec3 axis;                   ///< eigenvector of the other one
};

/// Values of the seven cubic forms whose weighted sum of squares is the discriminant of the characteristic polynomial: all vanish exactly
/// where two eigenvalues are equal (Zheng, Pang 2004; Parlett 2002). (l1-l2)^2 (l2-l3)^2 (l3-l1)^2 = f0^2 + f1^2 + f2^2 + f3^2 + 15
/// (f4^2 + f5^2 + f6^2).
void degeneracy_forms(const SymTensor& d, double (&f)[7]);

/// All isolated solutions inside the triangle, borders included, in a fixed order. Parts of it are ruled out where one of the forms has
/// Bernstein coefficients of one sign; in what is left, down to 1/32 of its sides, Newton's method on e_j T e_j = e_k T e_k, e_j T e_k = 0
/// for the nearest pair of eigenvectors (Friedland, Nocedal, Overton 1987) finds the places to 1e-12.
void degenerate_places(const SymTensor& a, const SymTensor& b, const SymTensor& c, std::vector<DegeneratePlace>& out);

}  // namespace sg
