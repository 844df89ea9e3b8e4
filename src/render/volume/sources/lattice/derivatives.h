// SPDX-License-Identifier: Apache-2.0
// Derivatives of a field at its samples along an axis: those of parabolas through three of them (docs/decisions/0009-uneven-axes.md).
#pragma once

namespace sg::volume {

/// The derivative at a sample is back * (own - before) + on * (after - own).
struct DerivativeWeights {
  float back, on;
};
/// Of the parabola through the sample and its neighbours at distances `back` and `on` (0: there is none, the difference is one-sided).
inline DerivativeWeights derivative_weights(double back, double on) {
  if (!(back > 0)) return {0, on > 0 ? float(1 / on) : 0};
  if (!(on > 0)) return {float(1 / back), 0};
  return {float(on / (back * (back + on))), float(back / (on * (back + on)))};
}

/// The derivative at an outermost sample, from that at the one next to it and the difference over the cell between them: that of the
/// parabola through the three outermost samples, whose derivative is linear and equals that difference on average. On an axis of two
/// samples all three are the same.
template <class T>
T border_slope(T over_cell, T inner) {
  return 2 * over_cell - inner;
}

}  // namespace sg::volume
