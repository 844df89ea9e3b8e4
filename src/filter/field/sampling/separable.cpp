// SPDX-License-Identifier: Apache-2.0
#include "filter/field/sampling/separable.h"

#include <algorithm>

#include "base/parallel.h"

namespace sg {

void sum_along(size_t axis, const std::vector<AxisSum>& sums, const float* in, std::array<size_t, 3> dims, float* out,
               const Context* context) {
  const size_t n = dims[axis], m = sums.size();
  const size_t stride = axis == 0 ? 1 : axis == 1 ? dims[0] : dims[0] * dims[1], outer = dims[0] * dims[1] * dims[2] / (stride * n);
  parallel_for(
      outer * m, std::max<size_t>(1, 16384 / stride),
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) {
          const AxisSum& s = sums[row % m];
          const float* from = in + row / m * stride * n + s.first * stride;
          float* to = out + row * stride;
          if (stride == 1) {
            float sum = 0;
            for (size_t k = 0; k < s.weight.size(); ++k) sum += s.weight[k] * from[k];
            *to = sum;
            continue;
          }
          std::fill(to, to + stride, 0.0f);
          for (size_t k = 0; k < s.weight.size(); ++k)
            for (size_t x = 0; x < stride; ++x) to[x] += s.weight[k] * from[k * stride + x];
        }
      },
      context);
}

}  // namespace sg
