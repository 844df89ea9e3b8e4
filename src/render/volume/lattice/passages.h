// SPDX-License-Identifier: Apache-2.0
// How rays pass the fine bricks of a lattice, in one byte each: what strides look up at every turn.
#pragma once
#include "render/volume/lattice/bends.h"
#include "render/volume/lattice/empty_space.h"

namespace sg::volume {

struct Passages {
  static constexpr uint8_t drawn = 16;  ///< the distances of empty bricks are below
  /// Below `drawn`: all bricks nearer than that draw nothing. From there on: the code of Bends, rounded up to `drawn`. Three more bytes:
  /// any can be read as a word.
  Plane<uint8_t> codes;
  float range;  ///< of Bends

  /// `empty` null: nothing is leapt over.
  Passages(const Bends& bends, const Distances* empty);
};

}  // namespace sg::volume
