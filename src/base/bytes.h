// SPDX-License-Identifier: Apache-2.0
// Byte order and overflow-checked sizes.
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace sg {

static_assert(std::endian::native == std::endian::little, "Sightglass runs on little-endian machines");

/// Reads a T from unaligned bytes, swapping when `big_endian`.
template <class T>
T load(const void* p, bool big_endian = false) {
  unsigned char b[sizeof(T)];
  std::memcpy(b, p, sizeof(T));
  if (big_endian)
    for (size_t i = 0; i < sizeof(T) / 2; ++i) {
      const unsigned char t = b[i];
      b[i] = b[sizeof(T) - 1 - i];
      b[sizeof(T) - 1 - i] = t;
    }
  T v;
  std::memcpy(&v, b, sizeof(T));
  return v;
}

/// Reverses the bytes of each of n elements of `size` (1, 2, 4, 8) bytes in place; parallel above 1 MiB.
void swap_bytes(void* data, size_t n, size_t size);
/// The same, from src to dst (may not overlap).
void swap_bytes_copy(void* dst, const void* src, size_t n, size_t size);

/// a*b into r; false on overflow. For sizes read from files.
[[nodiscard]] inline bool multiply(uint64_t a, uint64_t b, uint64_t& r) { return !__builtin_mul_overflow(a, b, &r); }
[[nodiscard]] inline bool add(uint64_t a, uint64_t b, uint64_t& r) { return !__builtin_add_overflow(a, b, &r); }

}  // namespace sg
