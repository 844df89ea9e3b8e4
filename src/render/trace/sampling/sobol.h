// SPDX-License-Identifier: Apache-2.0
// The first two dimensions of Sobol's sequence: a (0,2)-sequence, of which every aligned block of 2^k points is a (0,2)-net.
//
// Samplers pad: each pair of dimensions is this sequence in an order and a scrambling of its own (sampler.h). Direction numbers for many
// dimensions would be a table of someone else's search, their pairs far from the first are poor for few samples, and paths have no last
// dimension.
#pragma once
#include <cstdint>

#include "render/trace/sampling/owen.h"

namespace sg::trace {

/// First coordinate of point `index`, as a fraction of 2^32: the radical inverse in base 2. Bits of the index above the 32nd move it by
/// less than that.
constexpr uint32_t sobol_first(uint64_t index) { return reverse_bits(uint32_t(index)); }

/// The digits of the second coordinate, the first one in the lowest bit. Its generator matrix is Pascal's triangle mod 2, binomial(j, i)
/// for digit i and bit j of the index, which is odd where the bits of i are among those of j: each digit is the sum of the bits of the
/// index whose numbers include its own. Six halvings add them up.
constexpr uint32_t sobol_second_digits(uint64_t index) {
  index ^= (index & 0xAAAAAAAAAAAAAAAAull) >> 1;
  index ^= (index & 0xCCCCCCCCCCCCCCCCull) >> 2;
  index ^= (index & 0xF0F0F0F0F0F0F0F0ull) >> 4;
  index ^= (index & 0xFF00FF00FF00FF00ull) >> 8;
  index ^= (index & 0xFFFF0000FFFF0000ull) >> 16;
  return uint32_t(index ^ index >> 32);
}
/// Second coordinate.
constexpr uint32_t sobol_second(uint64_t index) { return reverse_bits(sobol_second_digits(index)); }

}  // namespace sg::trace
