// SPDX-License-Identifier: Apache-2.0
// How bright linear RGB is: the weights of ITU-R BT.709, whose primaries are those of sRGB.
#pragma once
#include "base/vec.h"

namespace sg::trace {

inline float luminance(Vec3f c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

}  // namespace sg::trace
