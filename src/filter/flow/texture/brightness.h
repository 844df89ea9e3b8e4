// SPDX-License-Identifier: Apache-2.0
// From values of convolved noise to greys, the same for textures of meshes and of pictures.
#pragma once
#include <cmath>

namespace sg {

/// Brightness 0 to 1 of a value that lies z standard deviations from the mean: about the share of the normal distribution below it, within
/// 0.01.
template <class T>
T normal_brightness(T z) {
  const T s = T(0.8) * z;
  return T(0.5) + T(0.5) * s / std::sqrt(T(1) + s * s);
}

}  // namespace sg
