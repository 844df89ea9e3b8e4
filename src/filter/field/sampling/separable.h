// SPDX-License-Identifier: Apache-2.0
// Weighted sums along one axis of a lattice of samples: what filters that are products of three do three times.
#pragma once
#include <array>
#include <vector>

#include "base/context.h"

namespace sg {

/// One result along an axis: the sum of weight[k] * sample[first + k].
struct AxisSum {
  size_t first = 0;
  std::vector<float> weight;
};

/// Samples dims, x fastest -> the same with sums.size() in place of dims[axis].
void sum_along(size_t axis, const std::vector<AxisSum>& sums, const float* in, std::array<size_t, 3> dims, float* out,
               const Context* context);

}  // namespace sg
