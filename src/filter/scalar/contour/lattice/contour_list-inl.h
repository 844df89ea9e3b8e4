// SPDX-License-Identifier: Apache-2.0
// Set bits to lists, for files that are compiled once for each target and have included Highway. Inside filter/scalar only.
#if defined(SG_CONTOUR_LIST_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_CONTOUR_LIST_INL
#undef SG_CONTOUR_LIST_INL
#else
#define SG_CONTOUR_LIST_INL
#endif
#include <bit>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace sg::contouring::HWY_NAMESPACE {

// first + i for each set bit i goes to list[count] and so on; returns the new count. Writes up to 16 numbers behind that. Most words have
// few bits: four are written without a look at how many there are.
HWY_INLINE size_t list_bits(uint64_t bits, uint32_t first, uint32_t* HWY_RESTRICT list, size_t count) {
  const size_t n = size_t(hwy::PopCount(bits));
  volatile uint32_t* to = list + count;  // volatile: kept separately, since gathering them in a vector takes longer than storing each
  for (size_t k = 0; k < 4; ++k, bits &= bits - 1) to[k] = first + uint32_t(std::countr_zero(bits));
  if (HWY_LIKELY(n <= 4)) return count + n;
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
  count += 4;
  auto numbers = _mm512_add_epi32(_mm512_set1_epi32(int(first)), _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0));
  for (int part = 0; part < 4; ++part) {
    const auto some = __mmask16(bits >> (16 * part));
    _mm512_storeu_si512(list + count, _mm512_maskz_compress_epi32(some, numbers));
    count += size_t(_mm_popcnt_u32(some));
    numbers = _mm512_add_epi32(numbers, _mm512_set1_epi32(16));
  }
  return count;
#else
  for (count += 4; bits; bits &= bits - 1) list[count++] = first + uint32_t(std::countr_zero(bits));
  return count;
#endif
}

}  // namespace sg::contouring::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
