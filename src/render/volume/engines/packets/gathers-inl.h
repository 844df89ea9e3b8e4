// SPDX-License-Identifier: Apache-2.0
// One number, or some that are neighbours in memory, for every lane. `loads`: by a load for each lane instead of gathers (gathers.h).
#if defined(SG_GATHERS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_GATHERS_INL_H
#undef SG_GATHERS_INL_H
#else
#define SG_GATHERS_INL_H
#endif

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "base/simd/vector-inl.h"

#define SG_HARDWARE_GATHERS (HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2)

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

template <class D>
using IntTag = hn::RebindToSigned<D>;

template <class D>
constexpr int lanes_of = int(hn::MaxLanes(D()));

/// Values that are neighbours in memory.
template <class D>
struct Pair {
  Float<D> a, b;
};
template <class D>
struct Quad {
  Pair<D> low, high;
};

#if SG_HARDWARE_GATHERS
/// Two numbers of each block of four from a, then two from b.
template <int which>
HWY_INLINE __m256 shuffled(__m256 a, __m256 b) {
  return _mm256_shuffle_ps(a, b, which);
}
#if HWY_TARGET <= HWY_AVX3
template <int which>
HWY_INLINE __m512 shuffled(__m512 a, __m512 b) {
  return _mm512_shuffle_ps(a, b, which);
}

// A gather of all lanes whose mask the compiler cannot see through: it would leave out the zeros, and then each gather waits for
// what its register held before.
HWY_INLINE __m512i gather_longs(const void* data, __m256i at) {
  __mmask8 all = 0xFF;
  asm("" : "+Yk"(all));
  return _mm512_mask_i32gather_epi64(_mm512_setzero_si512(), all, at, data, 4);
}
HWY_INLINE __m512i gather_ints(const void* data, __m512i at) {
  __mmask16 all = 0xFFFF;
  asm("" : "+Yk"(all));
  return _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), all, at, data, 1);
}
#endif

/// Where eight lanes read.
struct EightIndices {
  uint32_t at[8];
  HWY_INLINE explicit EightIndices(__m256i v) {
    // Two at a time: single ones take more steps, and those through memory wait longer.
    const __m128i low = _mm256_castsi256_si128(v), high = _mm256_extracti128_si256(v, 1);
    const uint64_t two[4] = {uint64_t(_mm_cvtsi128_si64(low)), uint64_t(_mm_extract_epi64(low, 1)), uint64_t(_mm_cvtsi128_si64(high)),
                             uint64_t(_mm_extract_epi64(high, 1))};
    for (int i = 0; i < 8; ++i) at[i] = uint32_t(two[i / 2] >> 32 * (i % 2));
  }
  HWY_INLINE explicit EightIndices(const int32_t* from) { std::memcpy(at, from, sizeof at); }
};
struct EightPairs {
  __m256 a, b;
};
/// The pairs of the lanes 0 1 4 5 side by side in x, those of 2 3 6 7 in y.
struct LoadedPairs {
  __m256 x, y;
};

template <class T>
HWY_INLINE __m256 load_words(const T* data, const EightIndices& i) {
  const auto four = [&](int n) HWY_ATTR {
    int32_t v[4];
    for (int k = 0; k < 4; ++k) std::memcpy(&v[k], data + i.at[n + k], sizeof v[k]);
    return _mm_insert_epi32(_mm_insert_epi32(_mm_insert_epi32(_mm_cvtsi32_si128(v[0]), v[1], 1), v[2], 2), v[3], 3);
  };
  return _mm256_castsi256_ps(_mm256_inserti128_si256(_mm256_castsi128_si256(four(0)), four(4), 1));
}
HWY_INLINE __m128 load_two_pairs(const float* first, const float* second) {
  const __m128i low = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(first));
  return _mm_loadh_pi(_mm_castsi128_ps(low), reinterpret_cast<const __m64*>(second));
}
HWY_INLINE LoadedPairs load_side_by_side(const float* data, const EightIndices& i) {
  const auto two = [&](int n) HWY_ATTR { return load_two_pairs(data + i.at[n], data + i.at[n + 1]); };
  const auto four = [&](int n) HWY_ATTR { return _mm256_insertf128_ps(_mm256_castps128_ps256(two(n)), two(n + 4), 1); };
  return {four(0), four(2)};
}
HWY_INLINE EightPairs load_pairs(const float* data, const EightIndices& i) {
  const LoadedPairs p = load_side_by_side(data, i);
  return {shuffled<0x88>(p.x, p.y), shuffled<0xDD>(p.x, p.y)};
}
HWY_INLINE Pair<hn::CappedTag<float, 4>> load_four_pairs(const float* data, const int32_t* at) {
  const __m128 x = load_two_pairs(data + at[0], data + at[1]), y = load_two_pairs(data + at[2], data + at[3]);
  using V = hn::Vec<hn::CappedTag<float, 4>>;
  return {V{_mm_shuffle_ps(x, y, 0x88)}, V{_mm_shuffle_ps(x, y, 0xDD)}};
}
HWY_INLINE void load_quads(const float* data, const EightIndices& i, __m256 out[4]) {
  const auto two = [&](int n) HWY_ATTR {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(data + i.at[n])), _mm_loadu_ps(data + i.at[n + 4]), 1);
  };
  const __m256 x = two(0), y = two(1), z = two(2), w = two(3);
  const __m256 xy = _mm256_unpacklo_ps(x, y), zw = _mm256_unpacklo_ps(z, w), xy2 = _mm256_unpackhi_ps(x, y), zw2 = _mm256_unpackhi_ps(z, w);
  out[0] = _mm256_shuffle_ps(xy, zw, 0x44), out[1] = _mm256_shuffle_ps(xy, zw, 0xEE);
  out[2] = _mm256_shuffle_ps(xy2, zw2, 0x44), out[3] = _mm256_shuffle_ps(xy2, zw2, 0xEE);
}
/// read(the indices of eight lanes, number of that half) for all lanes.
template <class D, class Read>
HWY_INLINE void by_halves(D, Int<D> at, const Read& read) {
#if HWY_TARGET <= HWY_AVX3
  if constexpr (lanes_of<D> == 16) {
    read(EightIndices(_mm512_castsi512_si256(at.raw)), 0), read(EightIndices(_mm512_extracti64x4_epi64(at.raw, 1)), 1);
    return;
  }
#endif
  if constexpr (lanes_of<D> == 8) read(EightIndices(at.raw), 0);
}
template <class D, class Read>
HWY_INLINE void by_halves(D, const int32_t* at, const Read& read) {
  for (int h = 0; h < lanes_of<D> / 8; ++h) read(EightIndices(at + 8 * h), h);
}
template <class D>
HWY_INLINE Float<D> joined(D, const __m256 half[2]) {
#if HWY_TARGET <= HWY_AVX3
  if constexpr (lanes_of<D> == 16) return Float<D>{_mm512_insertf32x8(_mm512_castps256_ps512(half[0]), half[1], 1)};
#endif
  if constexpr (lanes_of<D> == 8) return Float<D>{half[0]};
}
#endif

/// The 32-bit word that begins at byte `at` of the data.
template <class D>
HWY_INLINE Int<D> gather_words([[maybe_unused]] D d, const void* data, Int<D> at, [[maybe_unused]] bool loads) {
#if SG_HARDWARE_GATHERS
  if constexpr (lanes_of<D> >= 8) {
    if (loads) {
      __m256 half[2];
      by_halves(d, at, [&](const EightIndices& i, int h) HWY_ATTR { half[h] = load_words(static_cast<const char*>(data), i); });
      return bit_cast(IntTag<D>(), joined(d, half));
    }
  }
#if HWY_TARGET <= HWY_AVX3
  if constexpr (lanes_of<D> == 16) return Int<D>{gather_ints(data, at.raw)};
#endif
#endif
  return hn::GatherOffset(IntTag<D>(), static_cast<const int32_t*>(data), at);
}

#if SG_HARDWARE_GATHERS
/// Pairs as loads bring them: those of the lanes 0 1, 4 5, ... side by side in x, those of 2 3, 6 7, ... in y.
template <class D>
struct SideBySide {
  using F = Float<D>;
  F x, y;

  /// A number of each lane beside itself.
  static HWY_INLINE SideBySide twice(F f) { return {hn::InterleaveLower(D(), f, f), hn::InterleaveUpper(D(), f, f)}; }
  HWY_INLINE Pair<D> by_lanes() const { return {F{shuffled<0x88>(x.raw, y.raw)}, F{shuffled<0xDD>(x.raw, y.raw)}}; }
};
/// data[on[r] + at] and the next number, for every r.
template <class D, size_t n, class At>
HWY_INLINE void load_side_by_side(D d, const float* data, const ptrdiff_t (&on)[n], At at, SideBySide<D>* out) {
  __m256 x[n][2], y[n][2];
  by_halves(d, at, [&](const EightIndices& i, int h) HWY_ATTR {
    for (size_t r = 0; r < n; ++r) {
      const LoadedPairs p = load_side_by_side(data + on[r], i);
      x[r][h] = p.x, y[r][h] = p.y;
    }
  });
  for (size_t r = 0; r < n; ++r) out[r] = {joined(d, x[r]), joined(d, y[r])};
}
#endif

/// data[at] and data[at + 1], by gathers.
template <class D>
HWY_INLINE Pair<D> gathered_pair(D d, const float* data, Int<D> at) {
#if SG_HARDWARE_GATHERS
  if constexpr (lanes_of<D> >= 8) {
    // One 64-bit load brings both; then even and odd places are told apart.
    const hn::Repartition<int64_t, D> d64;
    const hn::Half<IntTag<D>> half;
    using V64 = hn::Vec<decltype(d64)>;
    const auto below = hn::LowerHalf(half, at).raw, above = hn::UpperHalf(half, at).raw;
    const auto longs = [data](auto from) HWY_ATTR {
#if HWY_TARGET <= HWY_AVX3
      if constexpr (lanes_of<D> == 16) return V64{gather_longs(data, from)};
      else
#endif
        return V64{_mm256_i32gather_epi64(reinterpret_cast<const long long*>(data), from, 4)};
    };
    const V64 lo = longs(below), hi = longs(above);
    return {hn::ConcatEven(d, bit_cast(d, hi), bit_cast(d, lo)), hn::ConcatOdd(d, bit_cast(d, hi), bit_cast(d, lo))};
  }
#endif
  return {hn::GatherIndex(d, data, at), hn::GatherIndex(d, data + 1, at)};
}

/// Places of lanes are told by a vector, or by the array it would be loaded from: single loads need them as scalars.
template <class D>
HWY_INLINE Int<D> in_vector(D, Int<D> at) {
  return at;
}
template <class D>
HWY_INLINE Int<D> in_vector(D, const int32_t* at) {
  return hn::Load(IntTag<D>(), at);
}

/// data[on[r] + at] and the next number, for every r.
template <class D, size_t n, class At>
HWY_INLINE void gather_pairs(D d, const float* data, const ptrdiff_t (&on)[n], At at, [[maybe_unused]] bool loads, Pair<D>* out) {
#if SG_HARDWARE_GATHERS
  if constexpr (lanes_of<D> == 4 && std::is_pointer_v<At>) {
    if (loads) {
      for (size_t r = 0; r < n; ++r) out[r] = load_four_pairs(data + on[r], at);
      return;
    }
  }
  if constexpr (lanes_of<D> >= 8) {
    if (loads) {
      // Told apart by eights: sixteen at a time, from SideBySide, takes 8 to 12 % longer in fixed steps.
      __m256 a[n][2], b[n][2];
      by_halves(d, at, [&](const EightIndices& i, int h) HWY_ATTR {
        for (size_t r = 0; r < n; ++r) {
          const EightPairs p = load_pairs(data + on[r], i);
          a[r][h] = p.a, b[r][h] = p.b;
        }
      });
      for (size_t r = 0; r < n; ++r) out[r] = {joined(d, a[r]), joined(d, b[r])};
      return;
    }
  }
#endif
  for (size_t r = 0; r < n; ++r) out[r] = gathered_pair(d, data + on[r], in_vector(d, at));
}
template <class D>
HWY_INLINE Pair<D> gather_pair(D d, const float* data, Int<D> at, bool loads) {
  Pair<D> p;
  gather_pairs(d, data, {0}, at, loads, &p);
  return p;
}

/// data[on[r] + at] and the next three numbers, for every r.
template <class D, size_t n>
HWY_INLINE void gather_quads(D d, const float* data, const ptrdiff_t (&on)[n], Int<D> at, [[maybe_unused]] bool loads, Quad<D>* out) {
#if SG_HARDWARE_GATHERS
  if constexpr (lanes_of<D> >= 8) {
    if (loads) {
      __m256 columns[n][4][2];
      by_halves(d, at, [&](const EightIndices& i, int h) HWY_ATTR {
        for (size_t r = 0; r < n; ++r) {
          __m256 v[4];
          load_quads(data + on[r], i, v);
          for (int c = 0; c < 4; ++c) columns[r][c][h] = v[c];
        }
      });
      for (size_t r = 0; r < n; ++r) {
        const auto& c = columns[r];
        out[r] = {{joined(d, c[0]), joined(d, c[1])}, {joined(d, c[2]), joined(d, c[3])}};
      }
      return;
    }
  }
#endif
  for (size_t r = 0; r < n; ++r) out[r] = {gathered_pair(d, data + on[r], at), gathered_pair(d, data + on[r] + 2, at)};
}
template <class D>
HWY_INLINE Quad<D> gather_quad(D d, const float* data, Int<D> at, bool loads) {
  Quad<D> q;
  gather_quads(d, data, {0}, at, loads, &q);
  return q;
}

/// The 32-bit words that begin at data[on[r] + at], for every r.
template <class D, class T, size_t n, class At>
HWY_INLINE void gather_words_at(D d, const T* data, const ptrdiff_t (&on)[n], At at, [[maybe_unused]] bool loads, Int<D>* out) {
#if SG_HARDWARE_GATHERS
  if constexpr (lanes_of<D> >= 8) {
    if (loads) {
      __m256 half[n][2];
      by_halves(d, at, [&](const EightIndices& i, int h) HWY_ATTR {
        for (size_t r = 0; r < n; ++r) half[r][h] = load_words(data + on[r], i);
      });
      for (size_t r = 0; r < n; ++r) out[r] = bit_cast(IntTag<D>(), joined(d, half[r]));
      return;
    }
  }
#endif
  const Int<D> first = in_vector(d, at), byte = sizeof(T) == 2 ? shift_left<1>(first) : first;
  for (size_t r = 0; r < n; ++r) out[r] = gather_words(d, data + on[r], byte, false);
}

/// How small integers are read out of words. Vector code is compiled once for one and two bytes, with and without a sign.
template <class D>
struct Integers {
  Int<D> last_word;  ///< the last word within the array begins at this number
  Int<D> code;       ///< the bits of 2^23, and the bit of the sign turned over
  Float<D> zero;     ///< 2^23, and half of the range where there is a sign
  bool two_bytes;    ///< each

  /// `array_bytes`: of all; `bytes`: of one.
  HWY_INLINE Integers(size_t array_bytes, size_t bytes, bool has_sign)
      : last_word(set(IntTag<D>(), (int(array_bytes) - 4) / int(bytes))),
        code(set(IntTag<D>(), 0x4B000000 | (has_sign ? 1 << (8 * bytes - 1) : 0))),
        zero(set(D(), float((1 << 23) + (has_sign ? 1 << (8 * bytes - 1) : 0)))),
        two_bytes(bytes == 2) {}
};

/// Small integer number k of a word. Its bits behind those of 2^23 are the float 2^23 + v; the difference is exact, as a conversion is.
template <class T, int k, class D>
HWY_INLINE Float<D> number_in(D d, Int<D> word, const Integers<D>& integers) {
  static_assert(std::is_unsigned_v<T>);
  constexpr int bits = 8 * sizeof(T);
  const IntTag<D> di;
  const hn::RebindToUnsigned<D> du;
  Int<D> number = bit_cast(di, shift_right<bits * k>(bit_cast(du, word)));
  if constexpr (bits * (k + 1) < 32) number = number & ((1 << bits) - 1);
  return bit_cast(d, number ^ integers.code) - integers.zero;
}
template <class T, class D>
HWY_INLINE Pair<D> pair_in(D d, Int<D> word, const Integers<D>& integers) {
  return {number_in<T, 0>(d, word, integers), number_in<T, 1>(d, word, integers)};
}

/// May words begin at `at` + on for all lanes? The last one within the array begins at `last_word`.
template <class D, size_t n, class At>
HWY_INLINE bool words_fit(D d, const ptrdiff_t (&on)[n], At at, Int<D> last_word) {
  return none(in_vector(d, at) > last_word - int(*std::max_element(on, on + n)));
}
/// A pair of small integers by one word, which near the end of the array starts earlier.
template <class D, class T>
HWY_INLINE Pair<D> gather_pair(D d, const T* data, Int<D> at, const Integers<D>& integers, bool loads) {
  const hn::RebindToUnsigned<D> du;
  constexpr int bits_by_shift = sizeof(T) == 2 ? 4 : 3;
  const Int<D> from = min(at, integers.last_word), skipped = shift_left<bits_by_shift>(at - from);
  Int<D> word;
  gather_words_at(d, data, {0}, from, loads, &word);
  return pair_in<T>(d, bit_cast(IntTag<D>(), bit_cast(du, word) >> bit_cast(du, skipped)), integers);
}
/// gather_pairs() of small integers near the end of the array. Out of line: it is long and rarely taken.
template <class D, class T, size_t n>
HWY_NOINLINE void gather_last_pairs(D d, const T* data, const ptrdiff_t (&on)[n], const Int<D>& at, const Integers<D>& integers, bool loads,
                                    Pair<D>* out) {
  for (size_t r = 0; r < n; ++r) out[r] = gather_pair(d, data, at + int(on[r]), integers, loads);
}
/// gather_pairs() of small integers.
template <class D, class T, size_t n, class At>
HWY_INLINE void gather_pairs(D d, const T* data, const ptrdiff_t (&on)[n], At at, const Integers<D>& integers, bool loads, Pair<D>* out) {
  if (words_fit(d, on, at, integers.last_word)) {
    Int<D> words[n];
    gather_words_at(d, data, on, at, loads, words);
    for (size_t r = 0; r < n; ++r) out[r] = pair_in<T>(d, words[r], integers);
    return;
  }
  gather_last_pairs(d, data, on, in_vector(d, at), integers, loads, out);
}
/// gather_quads() of small integers.
template <class D, class T, size_t n>
HWY_INLINE void gather_quads(D d, const T* data, const ptrdiff_t (&on)[n], Int<D> at, const Integers<D>& integers, bool loads,
                             Quad<D>* out) {
  if constexpr (sizeof(T) == 1) {
    if (words_fit(d, on, at, integers.last_word)) {
      Int<D> words[n];
      gather_words_at(d, data, on, at, loads, words);
      for (size_t r = 0; r < n; ++r)
        out[r] = {pair_in<T>(d, words[r], integers), {number_in<T, 2>(d, words[r], integers), number_in<T, 3>(d, words[r], integers)}};
      return;
    }
  }
  Pair<D> low[n], high[n];
  gather_pairs(d, data, on, at, integers, loads, low);
  gather_pairs(d, data, on, at + 2, integers, loads, high);
  for (size_t r = 0; r < n; ++r) out[r] = {low[r], high[r]};
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
