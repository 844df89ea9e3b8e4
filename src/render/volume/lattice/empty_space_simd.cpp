// SPDX-License-Identifier: Apache-2.0
#include "render/volume/lattice/empty_space_simd.h"

#include <algorithm>
#include <bit>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/volume/lattice/empty_space_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A loop of its own, so that no vector code is in the way of the ends of rows.
inline bool draws(MinMaxBricks::Range r, const DrawnEntries& e) {
  if (!(r.lo <= r.hi)) return false;
  const float a = std::min(std::max((r.lo - e.first) * e.per_axis, 0.0f), e.last),
              b = std::min(std::max((r.hi - e.first) * e.per_axis + 2, 0.0f), e.last);
  return e.drawn_before[size_t(int(b)) + 1] != e.drawn_before[size_t(int(a))];
}

void find_drawn_in(const MinMaxBricks::Range* ranges, size_t n, const DrawnEntries& e, uint8_t otherwise, uint64_t* bits,
                   uint8_t* distance) {
  const hn::CappedTag<float, 16> d;
  const hn::RebindToSigned<decltype(d)> di;
  const size_t lanes = hn::Lanes(d);
  const auto first = hn::Set(d, e.first), per = hn::Set(d, e.per_axis), last = hn::Set(d, e.last), zero = hn::Zero(d);
  const auto* table = reinterpret_cast<const int32_t*>(e.drawn_before);
  for (size_t x0 = 0; x0 < n; x0 += 64) {
    const size_t end = std::min<size_t>(64, n - x0);
    uint64_t word = 0;
    size_t x = 0;
    for (; x + lanes <= end; x += lanes) {
      hn::Vec<decltype(d)> lo, hi;
      hn::LoadInterleaved2(d, &ranges[x0 + x].lo, lo, hi);
      const auto some = hn::Le(lo, hi);
      const auto a = hn::IfThenElseZero(some, hn::Min(hn::Max(hn::Mul(hn::Sub(lo, first), per), zero), last));
      const auto b = hn::IfThenElseZero(some, hn::Min(hn::Max(hn::Add(hn::Mul(hn::Sub(hi, first), per), hn::Set(d, 2.0f)), zero), last));
      const auto before = hn::GatherIndex(di, table, hn::ConvertTo(di, a)), after = hn::GatherIndex(di, table + 1, hn::ConvertTo(di, b));
      const auto drawn = hn::And(some, hn::RebindMask(d, hn::Ne(before, after)));
      uint8_t found[8] = {};
      hn::StoreMaskBits(d, drawn, found);
      word |= (uint64_t(found[0]) | uint64_t(found[1]) << 8) << x;
    }
    for (; x < end; ++x) word |= uint64_t(draws(ranges[x0 + x], e)) << x;
    bits[x0 / 64] = word;
    for (size_t i = 0; i < end; ++i) distance[x0 + i] = word >> i & 1 ? uint8_t(0) : otherwise;
  }
}

void write_level_in(const uint64_t* bits, size_t n, uint8_t level, uint8_t* distance) {
  const hn::CappedTag<uint8_t, 64> d;
  const size_t lanes = hn::Lanes(d);
  for (size_t x0 = 0; x0 < n; x0 += 64) {
    const uint64_t word = bits[x0 / 64];
    if (word == 0) continue;
    const size_t end = std::min<size_t>(64, n - x0);
    size_t x = 0;
    for (; x + lanes <= end; x += lanes) {
      const uint64_t part = word >> x;
      uint8_t raw[8];
      for (int i = 0; i < 8; ++i) raw[i] = uint8_t(part >> 8 * i);
      const auto old = hn::LoadU(d, distance + x0 + x);
      hn::StoreU(hn::IfThenElse(hn::LoadMaskBits(d, raw), hn::Set(d, level), old), d, distance + x0 + x);
    }
    for (; x < end; ++x)
      if (word >> x & 1) distance[x0 + x] = level;
  }
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::volume {

HWY_EXPORT(find_drawn_in);
HWY_EXPORT(write_level_in);

void find_drawn(const MinMaxBricks::Range* ranges, size_t n, const DrawnEntries& entries, uint8_t otherwise, uint64_t* bits,
                uint8_t* distance) {
  HWY_DYNAMIC_DISPATCH(find_drawn_in)(ranges, n, entries, otherwise, bits, distance);
}

void write_level(const uint64_t* bits, size_t n, uint8_t level, uint8_t* distance) {
  HWY_DYNAMIC_DISPATCH(write_level_in)(bits, n, level, distance);
}

}  // namespace sg::volume
#endif
