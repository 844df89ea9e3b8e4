// SPDX-License-Identifier: Apache-2.0
// Noise as it is displayed.
#pragma once
#include <algorithm>

#include "image/image.h"

namespace sg::trace {

/// A variance of linear light about `mean` as a square of full scale on a screen: by the slope of sRGB's curve there, at least that of a
/// dark grey.
inline double displayed_variance(double mean, double variance) {
  constexpr float step = 0.01f;
  const float y = std::clamp(float(mean), 2 * step, 1.f);
  const double slope = double(srgb_encode(y + step) - srgb_encode(y - step)) / (2 * double(step));
  return variance * slope * slope;
}

}  // namespace sg::trace
