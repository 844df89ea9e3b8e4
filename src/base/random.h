// SPDX-License-Identifier: Apache-2.0
// Counter-based random numbers: the value depends on (seed, index) alone, so any thread may ask for any of them.
#pragma once
#include <cstdint>

#include "base/vec.h"

namespace sg {

/// 64 well-mixed bits of (seed, index). Finaliser of SplitMix64 (Steele, Lea, Flood 2014), applied twice.
SG_HD constexpr uint64_t random_bits(uint64_t seed, uint64_t index) {
  uint64_t z = seed * 0x9E3779B97F4A7C15ull + index;
  for (int round = 0; round < 2; ++round) {
    z += 0x9E3779B97F4A7C15ull;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    z ^= z >> 31;
  }
  return z;
}

/// Uniform in [0, 1) with 53 bits.
SG_HD constexpr double random_unit(uint64_t seed, uint64_t index) { return double(random_bits(seed, index) >> 11) * 0x1.0p-53; }

}  // namespace sg
