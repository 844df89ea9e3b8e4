// SPDX-License-Identifier: Apache-2.0
// How far two matrices are apart.
#pragma once
#include <algorithm>
#include <cmath>

#include "base/vec.h"

namespace sg::test {

/// The largest difference of their numbers.
inline double apart(const Mat3& a, const Mat3& b) {
  double most = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) most = std::max(most, std::abs(a.m[i][j] - b.m[i][j]));
  return most;
}

}  // namespace sg::test
