// SPDX-License-Identifier: Apache-2.0
// Affine maps of space, taken apart into translation, rotation and stretch, and interpolated by these.
#pragma once
#include "base/space/rotation.h"
#include "base/vec.h"

namespace sg {

/// p -> linear p + shift.
struct Affine {
  Mat3 linear;
  Vec3 shift;
  Vec3 operator()(Vec3 p) const { return linear * p + shift; }
  /// b, then a.
  friend Affine operator*(const Affine& a, const Affine& b) { return {a.linear * b.linear, a(b.shift)}; }
  friend bool operator==(const Affine&, const Affine&) = default;
};
/// Whether it makes no volume of nothing and nothing of none: finite, and not flat to rounding.
bool is_invertible(const Affine& a);
/// Throws an internal Error for a singular one.
Affine inverse(const Affine& a);
/// The box around the image of a box.
Box3 moved(const Affine& a, const Box3& box);

/// M = rotation stretch: a proper rotation, and a symmetric matrix that is positive definite, or negative definite where M mirrors (the
/// mirror through the origin is the only one that has no axis to choose; Shoemake, Duff, Matrix animation and polar decomposition, Graphics
/// Interface 1992).
struct Polar {
  Mat3 rotation, stretch;
};
/// By Newton's iteration with scaling (Higham, SIAM J. Sci. Stat. Comput. 7, 1986): the rotation is the nearest one to M in the Frobenius
/// norm. Throws Error(usage) for a matrix that is singular or not finite.
Polar polar_decomposition(const Mat3& m);

/// An affine map as its three parts: first the stretch, then the rotation, then the translation.
struct AffineParts {
  Vec3 shift;
  Quaternion rotation;
  Mat3 stretch;
};
/// Throws Error(usage) for a singular map.
AffineParts take_apart(const Affine& a);
Affine put_together(const AffineParts& parts);

/// Between two maps: translation and stretch linearly, the rotation by slerp along the shorter way; t may leave [0, 1]. Of two rigid
/// motions all between are rigid. From a map that mirrors to one that does not, it is flat somewhere on the way, as it must be.
Affine interpolate(const AffineParts& a, const AffineParts& b, double t);

}  // namespace sg
