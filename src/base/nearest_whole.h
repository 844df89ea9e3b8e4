// SPDX-License-Identifier: Apache-2.0
// A double as a number of an integer type.
#pragma once
#include <cmath>
#include <limits>

namespace sg {

/// The nearest T (halves to even); the ends of T beyond them (those of 64 bits are not doubles), 0 for NaN. Without a check any of these
/// would be undefined behaviour.
template <class T>
T nearest_whole(double v) {
  constexpr double lowest = double(std::numeric_limits<T>::min()), highest = double(std::numeric_limits<T>::max());
  const double r = std::nearbyint(v);
  if (r > lowest && r < highest) return T(r);
  return r >= highest ? std::numeric_limits<T>::max() : r <= lowest ? std::numeric_limits<T>::min() : T(0);
}

}  // namespace sg
