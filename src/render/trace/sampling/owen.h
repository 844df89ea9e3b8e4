// SPDX-License-Identifier: Apache-2.0
// Nested uniform scrambling of binary fractions (Owen 1995) by a hash, and orders of whole numbers without a table.
#pragma once
#include <cstdint>

namespace sg::trace {

/// The bits in reverse order: the radical inverse in base 2 of v, as a fraction of 2^32.
constexpr uint32_t reverse_bits(uint32_t v) {
  v = v << 16 | v >> 16;
  v = (v & 0x00FF00FFu) << 8 | (v & 0xFF00FF00u) >> 8;
  v = (v & 0x0F0F0F0Fu) << 4 | (v & 0xF0F0F0F0u) >> 4;
  v = (v & 0x33333333u) << 2 | (v & 0xCCCCCCCCu) >> 2;
  return (v & 0x55555555u) << 1 | (v & 0xAAAAAAAAu) >> 1;
}

/// A permutation of the numbers of 32 bits in which no bit depends on a higher one: on reversed bits a nested uniform scrambling. After
/// Laine and Karras (2011), constants of Vegdahl (2021).
constexpr uint32_t upward_permutation(uint32_t v, uint32_t seed) {
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return v;
}

/// Owen scrambling of the fraction v / 2^32: each bit is flipped or kept by what the seed draws for the bits before it (Burley 2020). Nets
/// stay nets. Of an index: an order in which every aligned block of 2^k indices stays one.
constexpr uint32_t owen_scrambled(uint32_t v, uint32_t seed) { return reverse_bits(upward_permutation(reverse_bits(v), seed)); }

namespace detail {
// A permutation of 0 ... count - 1: mixes within the next power of two and walks on until it is inside (Kensler 2013). Few bits mix badly.
constexpr uint32_t hashed_permutation(uint32_t i, uint32_t count, uint32_t seed) {
  uint32_t w = count - 1;
  w |= w >> 1, w |= w >> 2, w |= w >> 4, w |= w >> 8, w |= w >> 16;
  do {
    i ^= seed, i *= 0xe170893du;
    i ^= seed >> 16, i ^= (i & w) >> 4;
    i ^= seed >> 8, i *= 0x0929eb3fu;
    i ^= seed >> 23, i ^= (i & w) >> 1;
    i *= 1 | seed >> 27, i *= 0x6935fa69u;
    i ^= (i & w) >> 11, i *= 0x74dcb303u;
    i ^= (i & w) >> 2, i *= 0x9e501cc3u;
    i ^= (i & w) >> 2, i *= 0xc860a3dfu;
    i &= w, i ^= i >> 5;
  } while (i >= count);
  return (i + seed) % count;
}
}  // namespace detail

/// The place of i in a random order of 0 ... count - 1 that belongs to the seed, all of whose bits are used; i < count. Up to 16 every
/// order comes up equally often.
constexpr uint32_t permuted(uint32_t i, uint32_t count, uint64_t seed) {
  if (count > 16) return detail::hashed_permutation(detail::hashed_permutation(i, count, uint32_t(seed >> 32)), count, uint32_t(seed));
  // The last changes places with any up to it, then the one before, ...: where does i go? The seed holds all choices, as a fraction whose
  // digits are to the bases count, count - 1, ...; 16! is less than 2^45.
  for (uint32_t last = count - 1; last > 0; --last) {
    const uint64_t high = (seed >> 32) * (last + 1) + ((seed & 0xFFFFFFFF) * (last + 1) >> 32);
    const uint32_t other = uint32_t(high >> 32);
    seed *= last + 1;
    if (i == last) i = other;
    else if (i == other) i = last;
  }
  return i;
}

}  // namespace sg::trace
