// SPDX-License-Identifier: Apache-2.0
// The axes of a rectilinear grid, as packets of rays read them.
#pragma once
#include <cstdint>
#include <vector>

#include "render/volume/lattice/lattice_volume.h"

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
/// parabola through the three outermost samples, whose derivative goes straight and is that difference in the mean. On an axis of two
/// samples all three are the same.
inline float border_slope(float over_cell, float inner) { return 2 * over_cell - inner; }

struct UnevenAxes {
  struct Cell {
    float begin, per_width;  ///< q of its first sample, 1 / its width
  };
  std::vector<Cell> cells[3];  ///< one for every sample; the last has no width
  std::vector<DerivativeWeights> weights[3];
  std::vector<uint32_t> slices[3];  ///< of equal width: the cell in which each begins
  float first[3], slices_per_q[3];

  /// No cell is so much smaller than the whole that floats could not tell places in it.
  static bool fits(const Volume& volume);
  explicit UnevenAxes(const Volume& volume);
};

}  // namespace sg::volume
