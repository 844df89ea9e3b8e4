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

/// In the outermost cells derivatives lean to the inner sample: share f of the edge counts as f k / (1 + f (k - 1)). On even axes that
/// makes them differences of the field itself, over what there is of a cell to each side. Spans: between the neighbours of the cell's
/// samples.
inline double border_lean(bool outermost, double first_span, double last_span) { return outermost ? last_span / first_span : 1; }

struct UnevenAxes {
  struct Cell {
    float begin, per_width;  ///< q of its first sample, 1 / its width
  };
  std::vector<Cell> cells[3];  ///< one for every sample; the last has no width
  std::vector<DerivativeWeights> weights[3];
  std::vector<float> lean[3];       ///< of each cell, border_lean()
  std::vector<uint32_t> slices[3];  ///< of equal width: the cell in which each begins
  float first[3], slices_per_q[3];

  /// No cell is so much smaller than the whole that floats could not tell places in it.
  static bool fits(const Volume& volume);
  explicit UnevenAxes(const Volume& volume);
};

}  // namespace sg::volume
