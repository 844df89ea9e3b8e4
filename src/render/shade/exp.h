// SPDX-License-Identifier: Apache-2.0
// exp(-x), of which transmittance is made; exp-inl.h is the same for vectors.
#pragma once
#include <bit>

namespace sg {

/// exp(-x) for x >= 0 to 2e-7, 0 from 87 on: 2^-k exp(-r) with |r| <= ln2/2, Taylor's series to the 7th power.
inline float exp_minus(float x) {
  if (!(x < 87)) return 0;
  constexpr float ln2_hi = 0.693145752f, ln2_lo = 1.42860677e-6f, per_ln2 = 1.44269504f;
  const float k = float(int(x * per_ln2 + 0.5f)), r = -((x - k * ln2_hi) - k * ln2_lo);
  float sum = 1.0f / 5040;
  sum = sum * r + 1.0f / 720, sum = sum * r + 1.0f / 120, sum = sum * r + 1.0f / 24, sum = sum * r + 1.0f / 6;
  sum = sum * r + 0.5f, sum = sum * r + 1, sum = sum * r + 1;
  return sum * std::bit_cast<float>((127 - int(k)) << 23);
}

}  // namespace sg
