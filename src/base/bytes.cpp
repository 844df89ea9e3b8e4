// SPDX-License-Identifier: Apache-2.0
#include "base/bytes.h"

#include "base/error.h"
#include "base/parallel.h"

namespace sg {

namespace {

uint16_t reversed(uint16_t v) { return __builtin_bswap16(v); }
uint32_t reversed(uint32_t v) { return __builtin_bswap32(v); }
uint64_t reversed(uint64_t v) { return __builtin_bswap64(v); }

template <class T>
void swap_typed(void* dst, const void* src, size_t n) {
  parallel_for(n, (size_t(1) << 20) / sizeof(T), [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      T v;
      std::memcpy(&v, static_cast<const char*>(src) + i * sizeof(T), sizeof(T));
      v = reversed(v);
      std::memcpy(static_cast<char*>(dst) + i * sizeof(T), &v, sizeof(T));
    }
  });
}

}  // namespace

void swap_bytes_copy(void* dst, const void* src, size_t n, size_t size) {
  switch (size) {
    case 1:
      if (dst != src) std::memcpy(dst, src, n);
      return;
    case 2: return swap_typed<uint16_t>(dst, src, n);
    case 4: return swap_typed<uint32_t>(dst, src, n);
    case 8: return swap_typed<uint64_t>(dst, src, n);
  }
  fail_internal("swap_bytes: element size must be 1, 2, 4 or 8");
}

void swap_bytes(void* data, size_t n, size_t size) { swap_bytes_copy(data, data, n, size); }

}  // namespace sg
