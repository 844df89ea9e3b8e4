// SPDX-License-Identifier: Apache-2.0
// Samples to bits, a vector of samples at a time; every target gives the same bits.
#include "filter/scalar/contour/lattice/contour_bits.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/scalar/contour/lattice/contour_bits_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/simd/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::contouring::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

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
  if constexpr (std::is_floating_point_v<T>) return v >= limit;  // no NaN
  else return plain(!(limit > v));
}

// Bit i: p[i] >= least, for i < n <= 64, in vectors of up to `most` lanes.
template <size_t most, class T>
HWY_INLINE uint64_t word(const T* HWY_RESTRICT p, size_t n, T least) {
  const hn::CappedTag<T, most> d;
  const size_t lanes = hn::Lanes(d);
  const auto limit = set(d, least);
  uint64_t r = 0;
  size_t i = 0;
  for (; i + lanes <= n; i += lanes) r |= bits_of(d, not_below<T>(hn::LoadU(d, p + i), limit)) << i;
  for (; i < n; ++i) r |= uint64_t(p[i] >= least) << i;
  return r;
}

HWY_INLINE uint64_t last_word(size_t nx) { return nx % 64 ? ~uint64_t(0) >> (64 - nx % 64) : ~uint64_t(0); }

HWY_INLINE RowState state_of(uint64_t any, uint64_t every) {
  return any == 0 ? RowState::outside : every == ~uint64_t(0) ? RowState::inside : RowState::mixed;
}

template <class T>
void all_rows(const BitRows<T>& b) {
  const size_t whole = b.nx / 64;
  for (size_t r = 0; r < b.rows; ++r) {
    const T* HWY_RESTRICT p = b.samples + r * b.nx;
    uint64_t* HWY_RESTRICT out = b.bits + r * b.words;
    uint64_t any = 0, every = ~uint64_t(0);
    for (size_t w = 0; w < whole; ++w) {
      out[w] = word<64>(p + 64 * w, 64, b.least);
      any |= out[w], every &= out[w];
    }
    if (whole < b.words) {
      out[whole] = word<64>(p + 64 * whole, b.nx - 64 * whole, b.least);
      any |= out[whole], every &= out[whole] | ~last_word(b.nx);
    }
    b.state[r] = state_of(any, every);
  }
}

// Stretches whose ranges lie on one side of the level are known. The others are listed first, some rows at a time, so that their samples,
// each far from the last, are on the way from memory all together.
template <class T>
class SparseRows {
 public:
  explicit SparseRows(const BitRows<T>& rows) : b_(rows) {}

  void run() {
    for (size_t r = 0; r < b_.rows; ++r) {
      if (count_ + b_.nx / length + 16 > room) look();
      add(r);
    }
    look();
  }

 private:
  static constexpr size_t length = StretchRanges::length, room = 1024;
  struct Open {
    size_t word, from;  // of all bits, of all samples
    uint32_t shift, samples;
  };

  void add(size_t r) {
    constexpr uint64_t ones = 0xffff;
    const hn::CappedTag<uint8_t, 16> d;
    const size_t lanes = hn::Lanes(d), stretches = (b_.nx + length - 1) / length, first = (b_.first_row + r) * b_.ranges->per_row;
    const auto level = set(d, b_.level);
    const uint8_t *lo = &b_.ranges->lo[first], *hi = &b_.ranges->hi[first];
    uint64_t* HWY_RESTRICT out = b_.bits + r * b_.words;
    uint64_t any = 0, every = ~uint64_t(0);
    for (size_t s = 0; s < stretches; s += 16) {  // four words at a time
      uint64_t inside = 0, outside = 0;
      for (size_t l = 0; l < 16; l += lanes) {
        inside |= bits_of(d, hn::LoadU(d, lo + s + l) > level) << l;
        outside |= bits_of(d, level > hn::LoadU(d, hi + s + l)) << l;
      }
      const size_t here = std::min<size_t>(16, stretches - s), words = std::min<size_t>(4, b_.words - s / 4);
      const uint64_t valid = (uint64_t(1) << here) - 1;
      uint64_t mixed = ~(inside | outside) & valid;
      any |= (inside & valid) | mixed, every &= inside | ~valid;
      for (size_t w = 0; w < words; ++w) {
        const uint64_t four = inside & valid & ~mixed;
        out[s / 4 + w] = (four >> (4 * w) & 1) * ones | (four >> (4 * w + 1) & 1) * (ones << 16) |
                         (four >> (4 * w + 2) & 1) * (ones << 32) | (four >> (4 * w + 3) & 1) * (ones << 48);
      }
      for (; mixed; mixed &= mixed - 1) {
        const size_t at = s + size_t(std::countr_zero(mixed)), from = at * length;
        open_[count_++] = {r * b_.words + at / 4, r * b_.nx + from, uint32_t(16 * (at % 4)), uint32_t(std::min(length, b_.nx - from))};
        __builtin_prefetch(b_.samples + r * b_.nx + from, 0, 2);
      }
      if (count_ + 16 > room) look();
    }
    out[b_.words - 1] &= last_word(b_.nx);
    b_.state[r] = state_of(any, every);
  }

  void look() {
    for (size_t i = 0; i < count_; ++i) {
      const Open& o = open_[i];
      const T* HWY_RESTRICT p = b_.samples + o.from;
      b_.bits[o.word] |= (o.samples == length ? word<16>(p, length, b_.least) : word<16>(p, o.samples, b_.least)) << o.shift;
    }
    count_ = 0;
  }

  const BitRows<T>& b_;
  size_t count_ = 0;
  Open open_[room];
};

template <class T>
void rows_at_least(const BitRows<T>& b) {
  if (b.ranges) SparseRows<T>(b).run();
  else all_rows(b);
}

// NaN counts as less than all numbers.
template <class T>
bool ranges_of_row(const T* HWY_RESTRICT row, size_t nx, float* HWY_RESTRICT lo, float* HWY_RESTRICT hi) {
  constexpr size_t length = StretchRanges::length;
  bool nan = false;
  for (size_t s = 0; s * length < nx; ++s) {
    const T* HWY_RESTRICT p = row + s * length;
    const size_t n = std::min(length, nx - s * length);
    if constexpr (std::is_floating_point_v<T>) {
      if (n == length) {
        const hn::CappedTag<T, length> d;
        const auto least = set(d, T(-HUGE_VALF));
        auto low = -least, high = least;
        for (size_t i = 0; i < length; i += hn::Lanes(d)) {
          const auto v = hn::LoadU(d, p + i);
          const auto missing = is_nan(v);
          const auto known = select(missing, least, v);
          nan = nan || any(missing);
          low = min(low, known), high = max(high, known);
        }
        lo[s] = float(hn::GetLane(hn::MinOfLanes(d, low))), hi[s] = float(hn::GetLane(hn::MaxOfLanes(d, high)));
        continue;
      }
    }
    float low = HUGE_VALF, high = -HUGE_VALF;
    for (size_t i = 0; i < n; ++i) {
      const bool missing = p[i] != p[i];
      nan = nan || missing;
      const float v = missing ? -HUGE_VALF : float(p[i]);
      low = v < low ? v : low, high = v > high ? v : high;
    }
    lo[s] = low, hi[s] = high;
  }
  return nan;
}

template <class T>
bool holds_nan(const T* HWY_RESTRICT p, size_t n) {
  const hn::ScalableTag<T> d;
  const size_t lanes = hn::Lanes(d);
  auto odd = hn::FirstN(d, 0);
  size_t i = 0;
  for (; i + 2 * lanes <= n; i += 2 * lanes) {
    const auto a = hn::LoadU(d, p + i), b = hn::LoadU(d, p + i + lanes);
    odd = odd | (is_nan(a) | is_nan(b));
  }
  bool found = any(odd);
  for (; i < n; ++i) found = found || p[i] != p[i];
  return found;
}

void rows_u8(const BitRows<uint8_t>& b) { rows_at_least(b); }
void rows_i8(const BitRows<int8_t>& b) { rows_at_least(b); }
void rows_u16(const BitRows<uint16_t>& b) { rows_at_least(b); }
void rows_i16(const BitRows<int16_t>& b) { rows_at_least(b); }
void rows_f32(const BitRows<float>& b) { rows_at_least(b); }
void rows_f64(const BitRows<double>& b) { rows_at_least(b); }
bool ranges_u8(const uint8_t* row, size_t nx, float* lo, float* hi) { return ranges_of_row(row, nx, lo, hi); }
bool ranges_i8(const int8_t* row, size_t nx, float* lo, float* hi) { return ranges_of_row(row, nx, lo, hi); }
bool ranges_u16(const uint16_t* row, size_t nx, float* lo, float* hi) { return ranges_of_row(row, nx, lo, hi); }
bool ranges_i16(const int16_t* row, size_t nx, float* lo, float* hi) { return ranges_of_row(row, nx, lo, hi); }
bool ranges_f32(const float* row, size_t nx, float* lo, float* hi) { return ranges_of_row(row, nx, lo, hi); }
bool ranges_f64(const double* row, size_t nx, float* lo, float* hi) { return ranges_of_row(row, nx, lo, hi); }
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
HWY_EXPORT(ranges_u8);
HWY_EXPORT(ranges_i8);
HWY_EXPORT(ranges_u16);
HWY_EXPORT(ranges_i16);
HWY_EXPORT(ranges_f32);
HWY_EXPORT(ranges_f64);
HWY_EXPORT(nan_f32);
HWY_EXPORT(nan_f64);

void at_least(const BitRows<uint8_t>& b) { HWY_DYNAMIC_DISPATCH(rows_u8)(b); }
void at_least(const BitRows<int8_t>& b) { HWY_DYNAMIC_DISPATCH(rows_i8)(b); }
void at_least(const BitRows<uint16_t>& b) { HWY_DYNAMIC_DISPATCH(rows_u16)(b); }
void at_least(const BitRows<int16_t>& b) { HWY_DYNAMIC_DISPATCH(rows_i16)(b); }
void at_least(const BitRows<float>& b) { HWY_DYNAMIC_DISPATCH(rows_f32)(b); }
void at_least(const BitRows<double>& b) { HWY_DYNAMIC_DISPATCH(rows_f64)(b); }
bool stretch_ranges(const uint8_t* row, size_t nx, float* lo, float* hi) { return HWY_DYNAMIC_DISPATCH(ranges_u8)(row, nx, lo, hi); }
bool stretch_ranges(const int8_t* row, size_t nx, float* lo, float* hi) { return HWY_DYNAMIC_DISPATCH(ranges_i8)(row, nx, lo, hi); }
bool stretch_ranges(const uint16_t* row, size_t nx, float* lo, float* hi) { return HWY_DYNAMIC_DISPATCH(ranges_u16)(row, nx, lo, hi); }
bool stretch_ranges(const int16_t* row, size_t nx, float* lo, float* hi) { return HWY_DYNAMIC_DISPATCH(ranges_i16)(row, nx, lo, hi); }
bool stretch_ranges(const float* row, size_t nx, float* lo, float* hi) { return HWY_DYNAMIC_DISPATCH(ranges_f32)(row, nx, lo, hi); }
bool stretch_ranges(const double* row, size_t nx, float* lo, float* hi) { return HWY_DYNAMIC_DISPATCH(ranges_f64)(row, nx, lo, hi); }
bool any_nan(const float* p, size_t n) { return HWY_DYNAMIC_DISPATCH(nan_f32)(p, n); }
bool any_nan(const double* p, size_t n) { return HWY_DYNAMIC_DISPATCH(nan_f64)(p, n); }

}  // namespace sg::contouring
#endif
