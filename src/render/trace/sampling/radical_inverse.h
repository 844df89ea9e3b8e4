// SPDX-License-Identifier: Apache-2.0
// Radical inverses: the digits of a whole number mirrored at the point. Halton's sequence has one prime base for each dimension.
#pragma once
#include <cstdint>

namespace sg::trace {

/// The n-th prime, from prime(0) = 2 to prime(prime_count - 1).
constexpr uint32_t prime_count = 128;
uint32_t prime(uint32_t n);

/// sum of d_i base^(-i-1) for index = sum of d_i base^i; base >= 2. In [0, 1), exact to a rounding of double.
double radical_inverse(uint32_t base, uint64_t index);

/// The radical inverse with digits that are permuted at random, each by a permutation that belongs to the digits before it (Owen 1995); in
/// [0, 1). Of count = base^n indices from a multiple of count, each falls into another interval of length 1 / count. `indices`: all indices
/// that are ever asked for with this seed are below it; digits that are zero in all of them are replaced by one random number.
float owen_radical_inverse(uint32_t base, uint32_t index, uint32_t indices, uint64_t seed);

}  // namespace sg::trace
