// SPDX-License-Identifier: Apache-2.0
// The next coarser level of a slab of samples.
#pragma once
#include <array>

#include "data/array.h"

namespace sg::zarr {

struct Samples {
  ElementType type;
  int components = 1;
  bool labels = false;
};

/// Each sample of `out` is the mean of the 2 samples along each axis that is `halved` (of 1 at an odd end) that are not NaN, whole numbers
/// rounded to the nearest, halves up; of labels the most frequent one, the lowest of several. Packed, x fastest. Parallel over rows.
void halve(const Samples& samples, const std::byte* in, std::array<size_t, 3> dims, std::array<bool, 3> halved, std::byte* out);

}  // namespace sg::zarr
