// SPDX-License-Identifier: Apache-2.0
// Rows of numbers compared with limits: a bit each.
#pragma once
#include <cstddef>
#include <cstdint>

namespace sg {

/// Bits of the numbers above a level and of those below it; (n + 63) / 64 words each, bits behind the last are 0. Is one of them NaN?
bool compare_row(const float* x, size_t n, double level, uint64_t* above, uint64_t* below);
bool compare_row(const double* x, size_t n, double level, uint64_t* above, uint64_t* below);
/// Bits of the numbers in [lo, hi].
void range_row(const float* x, size_t n, double lo, double hi, uint64_t* bits);
void range_row(const double* x, size_t n, double lo, double hi, uint64_t* bits);

}  // namespace sg
