// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>

#include "base/vec.h"

namespace sg::trace {

/// What is left of light after a length in matter that absorbs (Beer, Lambert): exp(-absorption length). A ray that goes on
/// for ever has left its body, through a hole where no surface told so.
inline Vec3f fade(Vec3f absorption, float length) {
  Vec3f left{1, 1, 1};
  if (!std::isfinite(length)) return left;
  for (int c = 0; c < 3; ++c)
    if (absorption[c] > 0) left[c] = std::exp(-absorption[c] * length);
  return left;
}

}  // namespace sg::trace
