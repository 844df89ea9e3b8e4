// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/fronts/front.h"

namespace sg {

void stitch(const std::vector<int64_t>& below, const std::vector<int64_t>& above, const std::vector<Vec3>& points,
            std::vector<int64_t>& triangles) {
  size_t i = 0, j = 0;
  const auto emit = [&](int64_t a, int64_t b, int64_t c) {
    if (a != b && b != c && a != c) triangles.insert(triangles.end(), {a, b, c});
  };
  while (i + 1 < below.size() || j + 1 < above.size()) {
    bool lower = j + 1 >= above.size();
    if (!lower && i + 1 < below.size()) {
      const Vec3 along = points[size_t(below[i + 1])] - points[size_t(above[j])],
                 across = points[size_t(above[j + 1])] - points[size_t(below[i])];
      lower = dot(along, along) <= dot(across, across);
    }
    if (lower) {
      emit(below[i], below[i + 1], above[j]);
      ++i;
    } else {
      emit(below[i], above[j + 1], above[j]);
      ++j;
    }
  }
}

}  // namespace sg
