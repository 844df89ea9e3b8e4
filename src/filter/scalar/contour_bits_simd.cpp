// SPDX-License-Identifier: Apache-2.0
// Samples to bits, a vector of samples at a time; every target gives the same bits.
#include "filter/scalar/contour_bits.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/scalar/contour_bits_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sg::contouring::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D, class M>
HWY_INLINE uint64_t bits_of(D d, M mask) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  if constexpr (hn::MaxLanes(D()) <= 8) return bytes[0];
  uint64_t r;
  std::memcpy(&r, bytes, 8);
  return r;
}

template <class T, class V>
HWY_INLINE auto not_below(V v, V limit) {
  if constexpr (std::is_floating_point_v<T>) return hn::Ge(v, limit);  // no NaN
  else return hn::Not(hn::Gt(limit, v));
}

// Bit i: p[i] >= least, for i < n <= 64.
template <class T>
HWY_INLINE uint64_t word(const T* HWY_RESTRICT p, size_t n, T least) {
  const hn::CappedTag<T, 64> d;
  const size_t lanes = hn::Lanes(d);
  const auto limit = hn::Set(d, least);
  uint64_t r = 0;
  size_t i = 0;
  for (; i + lanes <= n; i += lanes) r |= bits_of(d, not_below<T>(hn::LoadU(d, p + i), limit)) << i;
  for (; i < n; ++i) r |= uint64_t(p[i] >= least) << i;
  return r;
}

template <class T>
void rows_at_least(const BitRows<T>& b) {
  const size_t whole = b.nx / 64;
  for (size_t r = 0; r < b.rows; ++r) {
    const T* HWY_RESTRICT p = b.samples + r * b.nx;
    uint64_t* HWY_RESTRICT out = b.bits + r * b.words;
    for (size_t w = 0; w < whole; ++w) out[w] = !b.wanted || b.wanted[w] ? word(p + 64 * w, 64, b.least) : b.otherwise[w];
    if (whole < b.words) out[whole] = !b.wanted || b.wanted[whole] ? word(p + 64 * whole, b.nx - 64 * whole, b.least) : b.otherwise[whole];
  }
}

template <class T>
bool holds_nan(const T* HWY_RESTRICT p, size_t n) {
  const hn::ScalableTag<T> d;
  const size_t lanes = hn::Lanes(d);
  auto odd = hn::FirstN(d, 0);
  size_t i = 0;
  for (; i + 2 * lanes <= n; i += 2 * lanes) {
    const auto a = hn::LoadU(d, p + i), b = hn::LoadU(d, p + i + lanes);
    odd = hn::Or(odd, hn::Or(hn::IsNaN(a), hn::IsNaN(b)));
  }
  bool any = !hn::AllFalse(d, odd);
  for (; i < n; ++i) any = any || p[i] != p[i];
  return any;
}

void rows_u8(const BitRows<uint8_t>& b) { rows_at_least(b); }
void rows_i8(const BitRows<int8_t>& b) { rows_at_least(b); }
void rows_u16(const BitRows<uint16_t>& b) { rows_at_least(b); }
void rows_i16(const BitRows<int16_t>& b) { rows_at_least(b); }
void rows_f32(const BitRows<float>& b) { rows_at_least(b); }
void rows_f64(const BitRows<double>& b) { rows_at_least(b); }
bool nan_f32(const float* p, size_t n) { return holds_nan(p, n); }
bool nan_f64(const double* p, size_t n) { return holds_nan(p, n); }

}  // namespace sg::contouring::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::contouring {

HWY_EXPORT(rows_u8);
HWY_EXPORT(rows_i8);
HWY_EXPORT(rows_u16);
HWY_EXPORT(rows_i16);
HWY_EXPORT(rows_f32);
HWY_EXPORT(rows_f64);
HWY_EXPORT(nan_f32);
HWY_EXPORT(nan_f64);

void at_least(const BitRows<uint8_t>& b) { HWY_DYNAMIC_DISPATCH(rows_u8)(b); }
void at_least(const BitRows<int8_t>& b) { HWY_DYNAMIC_DISPATCH(rows_i8)(b); }
void at_least(const BitRows<uint16_t>& b) { HWY_DYNAMIC_DISPATCH(rows_u16)(b); }
void at_least(const BitRows<int16_t>& b) { HWY_DYNAMIC_DISPATCH(rows_i16)(b); }
void at_least(const BitRows<float>& b) { HWY_DYNAMIC_DISPATCH(rows_f32)(b); }
void at_least(const BitRows<double>& b) { HWY_DYNAMIC_DISPATCH(rows_f64)(b); }
bool any_nan(const float* p, size_t n) { return HWY_DYNAMIC_DISPATCH(nan_f32)(p, n); }
bool any_nan(const double* p, size_t n) { return HWY_DYNAMIC_DISPATCH(nan_f64)(p, n); }

}  // namespace sg::contouring
#endif
