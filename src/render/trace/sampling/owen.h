// SPDX-License-Identifier: Apache-2.0
// Nested uniform scrambling of binary fractions (Owen 1995) by a hash, and orders of whole numbers without a table.
#pragma once
#include <cstdint>

namespace sg::trace {

/// The bits in reverse order: the radical inverse in base 2 of v, as a fraction of 2^32.
constexpr uint32_t reverse_bits(uint32_t v) {
  v = __builtin_bswap32(v);
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

/// The same of reversed bits: reverse_bits(v), scrambled.
constexpr uint32_t scrambled_reverse(uint32_t v, uint32_t seed) { return reverse_bits(upward_permutation(v, seed)); }
/// Owen scrambling of the fraction v / 2^32: each bit is flipped or kept by what the seed draws for the bits before it (Burley 2020). Nets
/// stay nets. Of an index: an order in which every aligned block of 2^k indices stays one.
constexpr uint32_t owen_scrambled(uint32_t v, uint32_t seed) { return scrambled_reverse(reverse_bits(v), seed); }

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

namespace detail {
/// exchange(a, b) for each exchange of a random order of up to 16: the last changes places with any up to it, then the one before, ... The
/// seed holds all choices, as a fraction whose digits are to the bases count, count - 1, ...; 16! is less than 2^45.
template <class Exchange>
constexpr void shuffle(uint32_t count, uint64_t seed, Exchange&& exchange) {
  for (uint32_t last = count - 1; last > 0; --last) {
    const uint64_t high = (seed >> 32) * (last + 1) + ((seed & 0xFFFFFFFF) * (last + 1) >> 32);
    seed *= last + 1;
    exchange(last, uint32_t(high >> 32));
  }
}
}  // namespace detail

/// The place of i in a random order of 0 ... count - 1 that belongs to the seed, all of whose bits are used; i < count. Up to 16 every
/// order comes up equally often.
constexpr uint32_t permuted(uint32_t i, uint32_t count, uint64_t seed) {
  if (count > 16) return detail::hashed_permutation(detail::hashed_permutation(i, count, uint32_t(seed >> 32)), count, uint32_t(seed));
  detail::shuffle(count, seed, [&](uint32_t a, uint32_t b) {
    if (i == a) i = b;
    else if (i == b) i = a;
  });
  return i;
}
/// All of them at once, of up to 16: that of i in the four bits from 4 i on.
constexpr uint64_t all_permuted(uint32_t count, uint64_t seed) {
  uint8_t at[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};  // which one has come to each place
  detail::shuffle(count, seed, [&](uint32_t a, uint32_t b) {
    const uint8_t kept = at[a];
    at[a] = at[b], at[b] = kept;
  });
  uint64_t places = 0;
  for (uint32_t place = 0; place < count; ++place) places |= uint64_t(place) << 4 * at[place];
  return places;
}

}  // namespace sg::trace
