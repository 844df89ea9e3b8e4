// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/lattice/space/empty_space_simd.h"

#include <algorithm>
#include <cstring>

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/volume/sources/lattice/space/empty_space_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/simd/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

// A loop of its own, so that no vector code is in the way of the ends of rows.
inline bool draws(MinMaxBricks::Range r, const DrawnRuns& runs) {
  const float lo = (r.lo - runs.first) * runs.per_axis, hi = (r.hi - runs.first) * runs.per_axis;
  bool found = false;
  for (int k = 0; k < runs.count; ++k) found = found || (lo <= runs.to[k] && hi >= runs.from[k]);
  return found && r.lo <= r.hi;
}

void find_drawn_in(const MinMaxBricks::Range* ranges, size_t n, const DrawnRuns& runs, uint64_t* bits) {
  const hn::CappedTag<float, 16> d;
  const size_t lanes = hn::Lanes(d);
  const auto first = set(d, runs.first), per = set(d, runs.per_axis);
  for (size_t x0 = 0; x0 < n; x0 += 64) {
    const size_t end = std::min<size_t>(64, n - x0);
    uint64_t word = 0;
    size_t x = 0;
    for (; x + lanes <= end; x += lanes) {
      hn::Vec<decltype(d)> lo, hi;
      hn::LoadInterleaved2(d, &ranges[x0 + x].lo, lo, hi);
      const auto a = (lo - first) * per, b = (hi - first) * per;
      auto drawn = hn::MaskFromVec(set(d, 0));
      for (int k = 0; k < runs.count; ++k) drawn = drawn | ((a <= runs.to[k]) & (b >= runs.from[k]));
      uint8_t found[8] = {};
      hn::StoreMaskBits(d, drawn & (lo <= hi), found);
      word |= (uint64_t(found[0]) | uint64_t(found[1]) << 8) << x;
    }
    for (; x < end; ++x) word |= uint64_t(draws(ranges[x0 + x], runs)) << x;
    bits[x0 / 64] = word;
  }
}

bool widen_in(const BitLattice& lattice, const uint64_t* from, size_t begin, size_t end, uint64_t* to, uint64_t* const* planes,
              int plane_count) {
  const hn::CappedTag<uint64_t, widen_words> d;
  using V = hn::Vec<decltype(d)>;
  const size_t lanes = hn::Lanes(d), row = lattice.row, layer = lattice.layer;
  constexpr size_t block = 64 * widen_words;
  alignas(64) uint64_t across[block + 2 * widen_words];  // along y and z; then along x
  V any = set(d, 0);
  for (size_t b = begin; b < end; b += block) {
    const size_t n = std::min(block, end - b);
    for (size_t i = 0; i < n + 2 * widen_words; i += lanes) {
      const uint64_t* p = from + b + i - widen_words;
      const auto three = [&](const uint64_t* q) HWY_ATTR { return hn::LoadU(d, q) | (hn::LoadU(d, q - row) | hn::LoadU(d, q + row)); };
      hn::Store(three(p) | (three(p - layer) | three(p + layer)), d, across + i);
    }
    for (size_t i = 0; i < n; i += lanes) {
      const uint64_t* p = across + widen_words + i;
      const V here = hn::Load(d, p), before = hn::LoadU(d, p - 1), after = hn::LoadU(d, p + 1);
      const V in_word = here | (shift_left<1>(here) | shift_right<1>(here));
      const V all = (in_word | (shift_right<63>(before) | shift_left<63>(after))) & hn::LoadU(d, lattice.used + b + i);
      const V found = hn::AndNot(hn::LoadU(d, from + b + i), all);
      hn::StoreU(all, d, to + b + i);
      for (int k = 0; k < plane_count; ++k) hn::StoreU(hn::LoadU(d, planes[k] + b + i) | found, d, planes[k] + b + i);
      any = any | found;
    }
  }
  return !all(any == 0);
}

void write_distances_in(const uint64_t* const* planes, const uint64_t* reached, size_t n, uint8_t* distance) {
  const hn::CappedTag<uint8_t, 64> d;
  const size_t lanes = hn::Lanes(d);
  for (size_t x0 = 0; x0 < n; x0 += 64) {
    alignas(64) uint8_t out[64];
    for (size_t x = 0; x < 64; x += lanes) {
      auto sum = set(d, 0);
      for (int k = 0; k < distance_planes; ++k) {
        const uint64_t part = (planes[k][x0 / 64] | ~reached[x0 / 64]) >> x;
        uint8_t raw[8];
        for (int i = 0; i < 8; ++i) raw[i] = uint8_t(part >> 8 * i);
        sum = sum | only(hn::LoadMaskBits(d, raw), set(d, uint8_t(1 << k)));
      }
      hn::Store(sum, d, out + x);
    }
    std::memcpy(distance + x0, out, std::min<size_t>(64, n - x0));
  }
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::volume {

HWY_EXPORT(find_drawn_in);
HWY_EXPORT(widen_in);
HWY_EXPORT(write_distances_in);

void find_drawn(const MinMaxBricks::Range* ranges, size_t n, const DrawnRuns& runs, uint64_t* bits) {
  HWY_DYNAMIC_DISPATCH(find_drawn_in)(ranges, n, runs, bits);
}

bool widen(const BitLattice& lattice, const uint64_t* from, size_t begin, size_t end, uint64_t* to, uint64_t* const* planes,
           int plane_count) {
  return HWY_DYNAMIC_DISPATCH(widen_in)(lattice, from, begin, end, to, planes, plane_count);
}

void write_distances(const uint64_t* const* planes, const uint64_t* reached, size_t n, uint8_t* distance) {
  HWY_DYNAMIC_DISPATCH(write_distances_in)(planes, reached, n, distance);
}

}  // namespace sg::volume
#endif
