// SPDX-License-Identifier: Apache-2.0
// Noise on a grid of pixels or voxels; the value of a pixel depends only on the seed and its number.
#pragma once
#include <cstdint>

#include "base/huge_allocator.h"

namespace sg::texture {

/// Even in [0, 1), in steps of 2^-16, so that sums of up to 256 values are exact in floats.
Plane<float> white_noise(const int32_t n[3], uint64_t seed);
/// 1 with the given probability, else 0.
Plane<float> sparse_noise(const int32_t n[3], uint64_t seed, double density);
/// The noise `make(n, ...)` on a coarser grid with `grain` pixels between its points, linear between them.
Plane<float> grained_noise(const int32_t n[3], uint64_t seed, double grain, bool sparse, double density);

}  // namespace sg::texture
