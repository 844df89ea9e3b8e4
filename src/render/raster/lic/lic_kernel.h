// SPDX-License-Identifier: Apache-2.0
// Weights of a LIC kernel, and what they do to the variance of noise.
#pragma once
#include <vector>

#include "scene/items/surface_texture.h"

namespace sg::raster {

/// Weight of the sample k steps forward (k < 0: back) at [steps + k], and for lines that end after `back` and `forward` steps the factor
/// that brings a weighted sum of the noise to variance 1. With the factor known beforehand, the contrast of a texture does not depend on
/// the picture, and does not flicker.
struct LicWeights {
  int steps = 0;
  std::vector<float> weight;  ///< 2 * steps + 1
  std::vector<float> factor;  ///< [back * (steps + 1) + forward]
};

/// Hann and box kernels; with a phase, times the ripples 1 + cos(2 pi (4 k / (2 steps + 1) - phase)) of Cabral and Leedom's moving
/// textures. `grain`: steps across a grain of noise, whose correlation over d steps is taken as max(0, 1 - d / grain). O(steps^2 * grain).
LicWeights lic_weights(const SurfaceTexture& texture, double grain);

}  // namespace sg::raster
