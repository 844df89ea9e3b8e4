// SPDX-License-Identifier: Apache-2.0
#include "render/trace/sampling/radical_inverse.h"

#include <algorithm>
#include <array>

#include "base/random.h"
#include "render/trace/sampling/owen.h"
#include "render/trace/sampling/unit_float.h"

namespace sg::trace {

namespace {

constexpr std::array<uint32_t, prime_count> primes = [] {
  std::array<uint32_t, prime_count> found{};
  uint32_t n = 0;
  for (uint32_t candidate = 2; n < prime_count; ++candidate) {
    bool divided = false;
    for (uint32_t i = 0; i < n && !divided; ++i) divided = candidate % found[i] == 0;
    if (!divided) found[n++] = candidate;
  }
  return found;
}();

}  // namespace

uint32_t prime(uint32_t n) { return primes[n]; }

double radical_inverse(uint32_t base, uint64_t index) {
  // The mirrored digits are a whole number of the same length: one division at the end, one rounding.
  uint64_t mirrored = 0, power = 1;
  while (index && power <= UINT64_MAX / base - 1) {
    mirrored = mirrored * base + index % base;
    power *= base, index /= base;
  }
  return std::min(double(mirrored) / double(power), 1 - 0x1p-53);
}

float owen_radical_inverse(uint32_t base, uint32_t index, uint32_t indices, uint64_t seed) {
  uint64_t mirrored = 0, power = 1, digit_number = 0;
  for (; power < indices; ++digit_number, power *= base, index /= base) {
    const uint64_t drawn = random_bits(seed + digit_number, mirrored);
    mirrored = mirrored * base + permuted(index % base, base, drawn);
  }
  const double rest = random_unit(seed + digit_number, mirrored);
  return below_one((double(mirrored) + rest) / double(power));
}

}  // namespace sg::trace
