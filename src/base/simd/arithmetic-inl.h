// SPDX-License-Identifier: Apache-2.0
// Products and sums rounded once, and conversions. Where a machine has no such instruction the C library computes the same bits, slowly.
// For files that are compiled once for each target and have included Highway.
#if defined(SG_BASE_ARITHMETIC_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_BASE_ARITHMETIC_INL_H
#undef SG_BASE_ARITHMETIC_INL_H
#else
#define SG_BASE_ARITHMETIC_INL_H
#endif

#include <cmath>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace sg::simd::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if (HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2) || HWY_ARCH_ARM_A64
/// a b + c
template <class V>
HWY_INLINE V mul_add(V a, V b, V c) {
  return hn::MulAdd(a, b, c);
}
/// c - a b
template <class V>
HWY_INLINE V neg_mul_add(V a, V b, V c) {
  return hn::NegMulAdd(a, b, c);
}
/// a b - c
template <class V>
HWY_INLINE V mul_sub(V a, V b, V c) {
  return hn::MulSub(a, b, c);
}
#else
template <class V>
HWY_INLINE V mul_add(V a, V b, V c) {
  const hn::DFromV<V> d;
  using T = hn::TFromV<V>;
  HWY_ALIGN T x[hn::MaxLanes(d)], y[hn::MaxLanes(d)], z[hn::MaxLanes(d)];
  hn::Store(a, d, x), hn::Store(b, d, y), hn::Store(c, d, z);
  for (size_t n = 0; n < hn::Lanes(d); ++n) z[n] = std::fma(x[n], y[n], z[n]);
  return hn::Load(d, z);
}
template <class V>
HWY_INLINE V neg_mul_add(V a, V b, V c) {
  return mul_add(hn::Neg(a), b, c);
}
template <class V>
HWY_INLINE V mul_sub(V a, V b, V c) {
  return mul_add(a, b, hn::Neg(c));
}
#endif

/// Truncated; |v| < 2^31 (hn::ConvertTo also handles larger ones, in four more instructions).
template <class V>
HWY_INLINE hn::Vec<hn::RebindToSigned<hn::DFromV<V>>> truncated(V v) {
  using DI = hn::RebindToSigned<hn::DFromV<V>>;
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
  if constexpr (hn::MaxLanes(hn::DFromV<V>()) == 16) return hn::Vec<DI>{_mm512_cvttps_epi32(v.raw)};
#endif
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  if constexpr (hn::MaxLanes(hn::DFromV<V>()) == 8) return hn::Vec<DI>{_mm256_cvttps_epi32(v.raw)};
#endif
  return hn::ConvertTo(DI(), v);
}

}  // namespace sg::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
