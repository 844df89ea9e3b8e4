// SPDX-License-Identifier: Apache-2.0
// Rows of bits, 64 to a word.
#pragma once
#include <cstddef>
#include <cstdint>

namespace sg {

/// Number of set bits, inline where the processor's instruction cannot be assumed (std::popcount makes a call there).
constexpr uint32_t count_bits(uint64_t v) {
  v -= v >> 1 & 0x5555555555555555u;
  v = (v & 0x3333333333333333u) + (v >> 2 & 0x3333333333333333u);
  return uint32_t(((v + (v >> 4)) & 0x0f0f0f0f0f0f0f0fu) * 0x0101010101010101u >> 56);
}

/// The bits of word `w` that represent the cells (or edges) between `points` points of a row.
constexpr uint64_t cell_bits(size_t w, size_t points) {
  const size_t from = 64 * w, cells = points - 1;
  return from >= cells ? 0 : cells - from >= 64 ? ~uint64_t(0) : ~uint64_t(0) >> (64 - (cells - from));
}

}  // namespace sg
