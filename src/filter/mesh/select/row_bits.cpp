// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/select/row_bits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/mesh/select/lattice_cells.h"

#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define SG_CLONES __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
#else
#define SG_CLONES
#endif

namespace sg {

namespace {

#define SG_ROW_KERNELS(T)                                                                                     \
  SG_CLONES bool compare_words(const T* x, size_t words, T most, T least, uint64_t* above, uint64_t* below) { \
    int odd = 0;                                                                                              \
    for (size_t w = 0; w < words; ++w, x += 64) {                                                             \
      uint8_t more[64], less[64];                                                                             \
      for (size_t i = 0; i < 64; ++i) more[i] = x[i] > most;                                                  \
      for (size_t i = 0; i < 64; ++i) less[i] = x[i] < least;                                                 \
      for (size_t i = 0; i < 64; ++i) odd |= x[i] != x[i];                                                    \
      above[w] = packed_bits(more), below[w] = packed_bits(less);                                             \
    }                                                                                                         \
    return odd != 0;                                                                                          \
  }                                                                                                           \
  SG_CLONES void range_words(const T* x, size_t words, T least, T most, uint64_t* bits) {                     \
    for (size_t w = 0; w < words; ++w, x += 64) {                                                             \
      uint8_t in[64];                                                                                         \
      for (size_t i = 0; i < 64; ++i) in[i] = uint8_t(x[i] >= least) & uint8_t(x[i] <= most);                 \
      bits[w] = packed_bits(in);                                                                              \
    }                                                                                                         \
  }
SG_ROW_KERNELS(float)
SG_ROW_KERNELS(double)

// The largest T that is not above v and the smallest that is not below it: x > v is equivalent to x > floor_of(v).
template <class T>
T floor_of(double v) {
  const T t = T(v);
  return double(t) > v ? std::nextafter(t, -std::numeric_limits<T>::infinity()) : t;
}
template <class T>
T ceil_of(double v) {
  const T t = T(v);
  return double(t) < v ? std::nextafter(t, std::numeric_limits<T>::infinity()) : t;
}

// The numbers of the last, unfinished word; what follows them repeats the last one.
template <class T>
void fill_tail(const T* x, size_t n, T* tail) {
  for (size_t i = 0; i < 64; ++i) tail[i] = x[std::min(n / 64 * 64 + i, n - 1)];
}

template <class T>
bool compare(const T* x, size_t n, double level, uint64_t* above, uint64_t* below) {
  const T most = floor_of<T>(level), least = ceil_of<T>(level);
  const size_t words = n / 64;
  bool nan = compare_words(x, words, most, least, above, below);
  if (n % 64) {
    T tail[64];
    fill_tail(x, n, tail);
    nan |= compare_words(tail, 1, most, least, above + words, below + words);
    const uint64_t mask = (uint64_t(1) << n % 64) - 1;
    above[words] &= mask, below[words] &= mask;
  }
  return nan;
}

template <class T>
void range(const T* x, size_t n, double lo, double hi, uint64_t* bits) {
  const T least = ceil_of<T>(lo), most = floor_of<T>(hi);
  const size_t words = n / 64;
  range_words(x, words, least, most, bits);
  if (n % 64) {
    T tail[64];
    fill_tail(x, n, tail);
    range_words(tail, 1, least, most, bits + words);
    bits[words] &= (uint64_t(1) << n % 64) - 1;
  }
}

}  // namespace

bool compare_row(const float* x, size_t n, double level, uint64_t* above, uint64_t* below) { return compare(x, n, level, above, below); }
bool compare_row(const double* x, size_t n, double level, uint64_t* above, uint64_t* below) { return compare(x, n, level, above, below); }
void range_row(const float* x, size_t n, double lo, double hi, uint64_t* bits) { range(x, n, lo, hi, bits); }
void range_row(const double* x, size_t n, double lo, double hi, uint64_t* bits) { range(x, n, lo, hi, bits); }

}  // namespace sg
