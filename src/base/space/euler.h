// SPDX-License-Identifier: Apache-2.0
// Euler angles: three turns about the fixed axes, one after the other.
//
// Order xyz turns about x first, then y, then z: R = Rz Ry Rx. These are the same as turns about the body's own axes in the reverse order,
// z first, then the new y, then the new x. The first and the third axis may be the same one (xyx...).
//
// Gimbal lock: where the second angle is +-90 degrees (of orders that name an axis twice: 0 or 180), the first and the third turn are about
// the same line. Only their sum or difference is determined, and a motion through such a pose cannot be told by smooth angles: this is why
// rotations are interpolated as quaternions. euler_of() gives the whole turn to the first angle there, and says so.
#pragma once
#include <array>

#include "base/schema/enum_words.h"
#include "base/vec.h"

namespace sg {

enum class EulerOrder { xyz, xzy, yxz, yzx, zxy, zyx, xyx, xzx, yxy, yzy, zxz, zyz };
constexpr auto enum_words(EulerOrder) {
  using enum EulerOrder;
  return std::array{Word{"xyz", xyz}, Word{"xzy", xzy}, Word{"yxz", yxz}, Word{"yzx", yzx}, Word{"zxy", zxy}, Word{"zyx", zyx},
                    Word{"xyx", xyx}, Word{"xzx", xzx}, Word{"yxy", yxy}, Word{"yzy", yzy}, Word{"zxz", zxz}, Word{"zyz", zyz}};
}

/// The axes of an order, 0 to 2.
std::array<int, 3> axes_of(EulerOrder order);

/// Angles in degrees, in the order of the axes.
Mat3 euler_matrix(Vec3 degrees, EulerOrder order);

struct EulerAngles {
  Vec3 degrees;         ///< the second from -90 to 90, of orders that name an axis twice from 0 to 180; the others from -180 to 180
  bool locked = false;  ///< gimbal lock: the third is 0, and the first holds what there is of both
};
/// euler_matrix() of the result is `rotation` to rounding, near gimbal lock too: the third angle is that which remains when the first turn
/// is taken back (after Shoemake, Graphics Gems IV, 1994, whose angles are independent and lose digits there).
EulerAngles euler_of(const Mat3& rotation, EulerOrder order);

}  // namespace sg
