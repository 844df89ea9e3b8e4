// SPDX-License-Identifier: Apache-2.0
// Samples to bits: one streaming pass, written so that compilers vectorise it.
#include <cmath>
#include <type_traits>

#include "base/parallel.h"
#include "filter/scalar/contour_parts.h"

namespace sg::contouring {

namespace {

#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define SG_CLONES __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
#else
#define SG_CLONES
#endif

// 64 flags of 0 or 1 to bits: eight bytes at a time, gathered in the top byte by one multiplication.
inline uint64_t pack64(const uint8_t* flags) {
  uint64_t r = 0;
  for (int b = 0; b < 8; ++b) {
    uint64_t x;
    std::memcpy(&x, flags + 8 * b, 8);
    r |= (x * 0x0102040810204080ull) >> 56 << (8 * b);
  }
  return r;
}

#define SG_AT_LEAST(T)                                                         \
  SG_CLONES void at_least(const T* p, size_t words, T least, uint64_t* bits) { \
    for (size_t w = 0; w < words; ++w, p += 64) {                              \
      uint8_t flags[64];                                                       \
      for (size_t i = 0; i < 64; ++i) flags[i] = p[i] >= least;                \
      bits[w] = pack64(flags);                                                 \
    }                                                                          \
  }
SG_AT_LEAST(uint8_t)
SG_AT_LEAST(int8_t)
SG_AT_LEAST(uint16_t)
SG_AT_LEAST(int16_t)
SG_AT_LEAST(float)
SG_AT_LEAST(double)

#define SG_ANY_NAN(T)                                   \
  SG_CLONES bool any_nan(const T* p, size_t n) {        \
    int odd = 0;                                        \
    for (size_t i = 0; i < n; ++i) odd |= p[i] != p[i]; \
    return odd != 0;                                    \
  }
SG_ANY_NAN(float)
SG_ANY_NAN(double)

// The smallest T for which x >= value holds exactly when x >= it; `none` when there is no such number.
template <class T>
T threshold(double value, bool& none) {
  none = false;
  if constexpr (std::is_floating_point_v<T>) {
    T t = T(value);
    if (double(t) < value) t = std::nextafter(t, std::numeric_limits<T>::infinity());
    return t;
  } else {
    const double up = std::ceil(value);
    none = up > double(std::numeric_limits<T>::max());
    return up < double(std::numeric_limits<T>::min()) ? std::numeric_limits<T>::min() : none ? T(0) : T(up);
  }
}

// The word that the row fills in part.
template <class T>
void last_word(const T* row, size_t nx, T least, uint64_t* out) {
  const size_t whole = nx / 64, rest = nx % 64;
  T tail[64];
  for (size_t i = 0; i < 64; ++i) tail[i] = row[64 * whole + std::min(i, rest - 1)];
  at_least(tail, 1, least, out + whole);
  out[whole] &= ~uint64_t(0) >> (64 - rest);
}

template <class T>
void classify_row(const T* row, size_t nx, T least, uint64_t* out) {
  at_least(row, nx / 64, least, out);
  if (nx % 64) last_word(row, nx, least, out);
}

template <class F>
decltype(auto) native(const Array& a, F&& f) {
  switch (a.type()) {
    case ElementType::u8: return f(a.view<uint8_t>().data);
    case ElementType::i8: return f(a.view<int8_t>().data);
    case ElementType::u16: return f(a.view<uint16_t>().data);
    case ElementType::i16: return f(a.view<int16_t>().data);
    case ElementType::f32: return f(a.view<float>().data);
    default: return f(a.view<double>().data);
  }
}

size_t row_grain(size_t nx) { return std::max<size_t>(1, 65536 / std::max<size_t>(nx, 1)); }

}  // namespace

bool classify(const Array& samples, size_t nx, size_t rows, std::span<const double> values, std::span<uint64_t* const> bits, size_t words,
              Context& context) {
  return native(samples, [&](const auto* p) {
    using T = std::remove_cvref_t<decltype(*p)>;
    std::vector<std::pair<T, bool>> least;  // and whether no sample can be that large
    for (double v : values) {
      bool none = false;
      const T t = threshold<T>(v, none);
      least.emplace_back(t, none);
    }
    return parallel_reduce(
        rows, row_grain(nx), false,
        [&](size_t begin, size_t end) {
          bool nan = false;
          for (size_t r = begin; r < end; ++r) {
            const T* row = p + r * nx;
            for (size_t v = 0; v < values.size(); ++v) {
              uint64_t* out = bits[v] + r * words;
              if (least[v].second) std::fill(out, out + words, 0);
              else classify_row(row, nx, least[v].first, out);
            }
            if constexpr (std::is_floating_point_v<T>) nan = nan || any_nan(row, nx);
          }
          return nan;
        },
        [](bool a, bool b) { return a || b; }, &context);
  });
}

void classify_words(const Array& samples, size_t nx, size_t row, double value, const uint8_t* wanted, uint64_t* bits, size_t words) {
  native(samples, [&]<class T>(const T* all) {
    bool none = false;
    const T least = threshold<T>(value, none);
    const T* p = all + row * nx;
    uint64_t* out = bits + row * words;
    const size_t whole = nx / 64;
    for (size_t w = 0; w < words; ++w) {
      if (!wanted[w]) continue;
      if (none) out[w] = 0;
      else if (w == whole) last_word(p, nx, least, out);
      else at_least(p + 64 * w, 1, least, out + w);
    }
  });
}

bool any_missing(const Array& samples, Context& context) {
  return native(samples, [&]<class T>(const T* p) {
    if constexpr (std::is_floating_point_v<T>)
      return parallel_reduce(
          samples.count(), 65536, false, [&](size_t begin, size_t end) { return any_nan(p + begin, end - begin); },
          [](bool a, bool b) { return a || b; }, &context);
    return false;
  });
}

void find_missing(const Array& samples, size_t nx, size_t rows, uint64_t* bits, size_t words, Context& context) {
  const Sample f(samples);
  parallel_for(
      rows, row_grain(nx),
      [&](size_t begin, size_t end) {
        for (size_t r = begin; r < end; ++r)
          for (size_t i = 0; i < nx; ++i) bits[r * words + i / 64] |= uint64_t(std::isnan(f(r * nx + i))) << (i % 64);
      },
      &context);
}

}  // namespace sg::contouring
