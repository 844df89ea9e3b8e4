// SPDX-License-Identifier: Apache-2.0
// SymTensor: a symmetric 3x3 matrix as six numbers, and its eigen-decomposition.
#pragma once
#include "base/vec.h"

namespace sg {

/// A 2D tensor lies in xx, yy and xy; the rest is zero.
struct SymTensor {
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, xz = 0;

  friend SymTensor operator+(const SymTensor& a, const SymTensor& b) {
    return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.yz + b.yz, a.xz + b.xz};
  }
  friend SymTensor operator-(const SymTensor& a, const SymTensor& b) { return a + b * -1.0; }
  friend SymTensor operator*(const SymTensor& a, double s) { return {a.xx * s, a.yy * s, a.zz * s, a.xy * s, a.yz * s, a.xz * s}; }
  friend Vec3 operator*(const SymTensor& a, Vec3 v) {
    return {a.xx * v.x + a.xy * v.y + a.xz * v.z, a.xy * v.x + a.yy * v.y + a.yz * v.z, a.xz * v.x + a.yz * v.y + a.zz * v.z};
  }
  friend bool operator==(const SymTensor&, const SymTensor&) = default;

  double trace() const { return xx + yy + zz; }
  double determinant() const { return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz); }
  /// Square root of the sum of the squares of all nine entries.
  double norm() const;
  double max_abs() const;
  bool finite() const { return 0 * xx + 0 * yy + 0 * zz + 0 * xy + 0 * yz + 0 * xz == 0; }
  /// v^T D v.
  double along(Vec3 v) const { return dot(v, *this * v); }
  /// The tensor less a third of its trace on the diagonal.
  SymTensor deviator() const;
};

/// s v v^T.
SymTensor outer(Vec3 v, double s = 1);
/// R D R^T: the tensor when its axes become the columns of R.
SymTensor rotated(const SymTensor& d, const Mat3& r);

/// Eigenvalues in descending order; vector[k] belongs to value[k]. The vectors are orthonormal and right-handed, whatever the tensor;
/// the largest component of the first and of the second is positive.
struct Eigen3 {
  double value[3]{};
  Vec3 vector[3]{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
};

/// Cyclic Jacobi rotations on the tensor divided by its largest entry: all eigenvalues to a few 1e-16 of the largest, vectors orthonormal
/// to the same, also at equal eigenvalues and from 1e-300 to 1e300 (Golub and Van Loan, Matrix Computations, 8.5). A diagonal tensor gives
/// its entries exactly. NaN or infinity anywhere: all NaN.
Eigen3 eigen_of(const SymTensor& d);

/// Of the block xx, yy, xy only: two values in descending order and their vectors in the plane; the third is 0 along z.
Eigen3 eigen_in_plane(const SymTensor& d);

/// sum_k value[k] v_k v_k^T.
SymTensor compose(const Eigen3& e);
/// Matrix functions by eigenvalues. log_of wants positive eigenvalues: those below `floor` count as `floor`.
SymTensor log_of(const SymTensor& d, double floor);
SymTensor exp_of(const SymTensor& d);

}  // namespace sg
