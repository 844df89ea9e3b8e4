// SPDX-License-Identifier: Apache-2.0
// Rows of samples to rows of bits. Inside filter/scalar only.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

namespace sg::contouring {

/// What a row of bits holds.
enum class RowState : uint8_t { outside, inside, mixed };

/// Ranges of stretches of samples, from which most bits follow without a look at the samples. 1/8 byte a sample.
struct StretchRanges {
  static constexpr size_t length = 16;
  size_t per_row = 0;  ///< four for each word of bits
  float first = 0, scale = 0;
  std::vector<uint8_t> lo, hi;  ///< level() of the least and the largest sample; a NaN is less than all others
  /// Rising with x, though not always; 16 more than needed can be read behind the last.
  uint8_t level(float x) const { return uint8_t(std::min(std::max((x - first) * scale, 0.0f), 255.0f)); }
};

/// `rows` rows of `nx` samples, one behind the other, and as many rows of `words` = ceil(nx / 64) words. Bit i of a row is set for
/// samples >= least, bits behind the row are 0.
template <class T>
struct BitRows {
  const T* samples;
  size_t nx, rows;
  T least;
  uint64_t* bits;
  size_t words;
  RowState* state;
  const StretchRanges* ranges = nullptr;  ///< of all samples; null: every sample is looked at
  size_t first_row = 0;                   ///< in the ranges
  uint8_t level = 0;                      ///< of `least`
};
void at_least(const BitRows<uint8_t>& b);
void at_least(const BitRows<int8_t>& b);
void at_least(const BitRows<uint16_t>& b);
void at_least(const BitRows<int16_t>& b);
void at_least(const BitRows<float>& b);
void at_least(const BitRows<double>& b);

/// Least and largest of each stretch of a row; true when one is NaN, which counts as minus infinity here.
bool stretch_ranges(const uint8_t* row, size_t nx, float* lo, float* hi);
bool stretch_ranges(const int8_t* row, size_t nx, float* lo, float* hi);
bool stretch_ranges(const uint16_t* row, size_t nx, float* lo, float* hi);
bool stretch_ranges(const int16_t* row, size_t nx, float* lo, float* hi);
bool stretch_ranges(const float* row, size_t nx, float* lo, float* hi);
bool stretch_ranges(const double* row, size_t nx, float* lo, float* hi);

bool any_nan(const float* p, size_t n);
bool any_nan(const double* p, size_t n);

}  // namespace sg::contouring
