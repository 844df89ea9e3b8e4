// SPDX-License-Identifier: Apache-2.0
// field_stats: one streaming pass per array. Minimum and maximum do not depend on the order, so neither does the result.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/parallel.h"
#include "data/field.h"

namespace sg {

namespace {

// Packed runs vectorise: no branch, NaN drops out because every comparison with it is false.
template <class T>
struct RunStats {
  T lo, hi;
  uint64_t odd;  // NaN or infinite
};

#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define SG_CLONES __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
#else
#define SG_CLONES
#endif

#define SG_RUN_INT(T, name)                                   \
  SG_CLONES void name(const T* p, size_t n, RunStats<T>& s) { \
    T lo = s.lo, hi = s.hi;                                   \
    for (size_t i = 0; i < n; ++i) {                          \
      lo = p[i] < lo ? p[i] : lo;                             \
      hi = p[i] > hi ? p[i] : hi;                             \
    }                                                         \
    s.lo = lo, s.hi = hi;                                     \
  }
SG_RUN_INT(uint8_t, run)
SG_RUN_INT(int8_t, run)
SG_RUN_INT(uint16_t, run)
SG_RUN_INT(int16_t, run)
SG_RUN_INT(uint32_t, run)
SG_RUN_INT(int32_t, run)
SG_RUN_INT(uint64_t, run)
SG_RUN_INT(int64_t, run)

// 32 independent lanes, so that the compiler may vectorise the minimum without reordering a chain.
#define SG_RUN_FLOAT(T, I, mask)                                   \
  SG_CLONES void run(const T* p, size_t n, RunStats<T>& s) {       \
    constexpr size_t lanes = 32;                                   \
    T lo[lanes], hi[lanes];                                        \
    I odd[lanes] = {};                                             \
    for (size_t l = 0; l < lanes; ++l) lo[l] = s.lo, hi[l] = s.hi; \
    size_t i = 0;                                                  \
    for (; i + lanes <= n; i += lanes)                             \
      for (size_t l = 0; l < lanes; ++l) {                         \
        const T v = p[i + l];                                      \
        lo[l] = v < lo[l] ? v : lo[l];                             \
        hi[l] = v > hi[l] ? v : hi[l];                             \
        I b;                                                       \
        std::memcpy(&b, &p[i + l], sizeof b);                      \
        odd[l] |= I((b & I(mask)) == I(mask));                     \
      }                                                            \
    for (; i < n; ++i) {                                           \
      const T v = p[i];                                            \
      lo[0] = v < lo[0] ? v : lo[0];                               \
      hi[0] = v > hi[0] ? v : hi[0];                               \
      odd[0] |= I(!(v - v == 0));                                  \
    }                                                              \
    for (size_t l = 0; l < lanes; ++l) {                           \
      s.lo = lo[l] < s.lo ? lo[l] : s.lo;                          \
      s.hi = hi[l] > s.hi ? hi[l] : s.hi;                          \
      s.odd += odd[l];                                             \
    }                                                              \
  }
SG_RUN_FLOAT(float, uint32_t, 0x7F800000u)
SG_RUN_FLOAT(double, uint64_t, 0x7FF0000000000000ull)

template <class T>
FieldStats careful(const View<T>& v, const View<uint8_t>* skip, size_t begin, size_t end, bool with_magnitude) {
  FieldStats s;
  s.range.resize(size_t(v.components));
  for (size_t i = begin; i < end; ++i) {
    if (skip && (*skip)[i]) continue;
    double sum = 0;
    for (int c = 0; c < v.components; ++c) {
      const double x = double(v(i, c));
      sum += x * x;
      if (std::isfinite(x)) {
        Range& r = s.range[size_t(c)];
        if (x < r.lo) r.lo = x;
        if (x > r.hi) r.hi = x;
      } else {
        ++(std::isnan(x) ? s.nan : s.infinite);
      }
    }
    if (with_magnitude && std::isfinite(sum)) {
      const double m = std::sqrt(sum);
      s.magnitude.add({m, m});
    }
  }
  return s;
}

template <class T>
FieldStats fast_run(const View<T>& v, size_t begin, size_t end) {
  using L = std::numeric_limits<T>;
  RunStats<T> s{L::has_infinity ? L::infinity() : L::max(), L::has_infinity ? -L::infinity() : L::lowest(), 0};
  run(v.data + begin, end - begin, s);
  if (s.odd) return careful(v, nullptr, begin, end, false);
  FieldStats r;
  r.range.push_back({double(s.lo), double(s.hi)});
  return r;
}

}  // namespace

FieldStats field_stats(const Array& array, bool with_magnitude, const Array& skip) {
  FieldStats total;
  total.range.resize(size_t(array.components()));
  const bool skipping = skip.count() == array.count() && skip.count() > 0;
  const View<uint8_t> hidden = skipping ? skip.view<uint8_t>() : View<uint8_t>{};
  auto join = [](FieldStats a, const FieldStats& b) {
    for (size_t c = 0; c < b.range.size(); ++c) a.range[c].add(b.range[c]);
    a.magnitude.add(b.magnitude);
    a.nan += b.nan;
    a.infinite += b.infinite;
    return a;
  };
  return dispatch(array, [&](auto v) {
    const bool fast = !skipping && v.components == 1 && v.packed();
    const size_t grain = std::max<size_t>(1, (size_t(1) << (fast ? 18 : 16)) / size_t(v.components));
    return parallel_reduce(
        v.count, grain, std::move(total),
        [&](size_t begin, size_t end) {
          return fast ? fast_run(v, begin, end) : careful(v, skipping ? &hidden : nullptr, begin, end, with_magnitude && v.components > 1);
        },
        join);
  });
}

}  // namespace sg
