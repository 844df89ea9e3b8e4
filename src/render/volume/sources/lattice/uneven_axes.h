// SPDX-License-Identifier: Apache-2.0
// The axes of a rectilinear grid, as packets of rays read them.
#pragma once
#include <cstdint>
#include <vector>

#include "render/volume/sources/lattice/derivatives.h"
#include "render/volume/sources/lattice/lattice_volume.h"

namespace sg::volume {

struct UnevenAxes {
  struct Cell {
    float begin, per_width;  ///< q of its first sample, 1 / its width
  };
  std::vector<Cell> cells[3];  ///< one for every sample; the last has no width
  std::vector<DerivativeWeights> weights[3];
  std::vector<uint32_t> slices[3];  ///< of equal width: the cell in which each begins
  float first[3], slices_per_q[3];

  /// No cell is so small relative to the whole that floats cannot resolve positions in it.
  static bool fits(const Volume& volume);
  explicit UnevenAxes(const Volume& volume);
};

}  // namespace sg::volume
