// SPDX-License-Identifier: Apache-2.0
// Rows of samples to rows of bits. Inside filter/scalar only.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace sg::contouring {

/// `rows` rows of `nx` samples, one behind the other, and as many rows of `words` = ceil(nx / 64) words. Bit i of a row is set for
/// samples >= least, bits behind the row are 0. Where wanted[w] is 0, word w of all rows becomes otherwise[w] without a look at the
/// samples; null: all are wanted.
template <class T>
struct BitRows {
  const T* samples;
  size_t nx, rows;
  T least;
  uint64_t* bits;
  size_t words;
  const uint8_t* wanted = nullptr;
  const uint64_t* otherwise = nullptr;
};
void at_least(const BitRows<uint8_t>& b);
void at_least(const BitRows<int8_t>& b);
void at_least(const BitRows<uint16_t>& b);
void at_least(const BitRows<int16_t>& b);
void at_least(const BitRows<float>& b);
void at_least(const BitRows<double>& b);

bool any_nan(const float* p, size_t n);
bool any_nan(const double* p, size_t n);

}  // namespace sg::contouring
