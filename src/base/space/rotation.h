// SPDX-License-Identifier: Apache-2.0
// Rotations: about an axis, as unit quaternions, and as matrices. All are counter-clockwise seen against the axis.
#pragma once
#include "base/vec.h"

namespace sg {

/// w + x i + y j + z k. Unit quaternions are rotations, q and -q the same one.
struct Quaternion {
  double w = 1, x = 0, y = 0, z = 0;
  Quaternion conjugate() const { return {w, -x, -y, -z}; }
  friend bool operator==(const Quaternion&, const Quaternion&) = default;
};
double dot(const Quaternion& a, const Quaternion& b);
double length(const Quaternion& q);
/// Hamilton's product: the rotation b, then a.
Quaternion operator*(const Quaternion& a, const Quaternion& b);
/// Throws Error(usage) for zero and for numbers that are not finite.
Quaternion normalize(const Quaternion& q);

/// The sine and cosine of an angle in degrees; exact for quarter turns, so that a box turned by 90 degrees has straight numbers.
void sine_cosine(double degrees, double& sine, double& cosine);
/// Rodrigues' formula; the axis need not be of unit length. Throws Error(usage) for an axis of zero with an angle.
Mat3 turn_about(Vec3 axis, double degrees);
Quaternion quaternion_about(Vec3 axis, double degrees);

/// Of a unit quaternion.
Mat3 matrix_of(const Quaternion& q);
/// Of a rotation matrix, with w >= 0: by the largest of its four parts, so that nothing small is divided by (Shepperd, J. Guidance and
/// Control 1, 1978).
Quaternion quaternion_of(const Mat3& rotation);

/// From a at t = 0 to b at 1 with constant speed along the shorter way (Shoemake, SIGGRAPH 1985), of unit quaternions. Of a and a rotation
/// half a turn away both ways are as long; that of the signs as they are is taken.
Quaternion slerp(const Quaternion& a, Quaternion b, double t);

}  // namespace sg
