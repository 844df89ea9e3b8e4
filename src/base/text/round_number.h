// SPDX-License-Identifier: Apache-2.0
// Numbers that people would choose.
#pragma once
#include <algorithm>
#include <cmath>

namespace sg {

/// The number with the fewest digits (1, 2 or 5 times a power of ten times a whole number) that is no farther than `within` from `value`;
/// `value` itself where there is no room.
inline double round_near(double value, double within) {
  if (!(within > 0) || !std::isfinite(value) || !std::isfinite(within)) return value;
  if (std::abs(value) <= within) return 0;
  const int first = int(std::ceil(std::log10(std::abs(value)))), last = int(std::floor(std::log10(within))) - 1;
  for (int k = first; k >= last; --k)
    for (const double digit : {5.0, 2.0, 1.0}) {
      // Powers of ten below 1 are divided by: the double nearest to the decimal number.
      const double power = std::pow(10.0, std::abs(k)), step = k < 0 ? digit / power : digit * power;
      const double count = std::round(value / step), r = k < 0 ? count * digit / power : count * step;
      if (std::isfinite(r) && std::abs(r - value) <= within) return r;
    }
  return value;
}

/// The largest of 1, 2, 5, 10, 20, ... and 0.5, 0.2, ... that is at most `most`, which is positive and finite.
inline double round_below(double most) {
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  for (const double digit : {5.0, 2.0})
    if (digit * power <= most) return digit * power;
  return power;
}

}  // namespace sg
