// SPDX-License-Identifier: Apache-2.0
// How rays pass the fine bricks of a lattice, in one byte each: what strides look up at every turn.
#pragma once
#include <memory>

#include "render/volume/sources/lattice/bends.h"
#include "render/volume/sources/lattice/space/space_ahead.h"

namespace sg::volume {

struct Passages {
  static constexpr uint8_t drawn = 16;  ///< the distances of empty bricks are below
  /// Below `drawn`: as SpaceAhead::bricks. From there on: the code of Bends, rounded up to `drawn`. Three more bytes: any can be read as a
  /// word.
  Plane<uint8_t> codes;
  std::array<int32_t, 3> up{};  ///< as SpaceAhead::up
  std::shared_ptr<const Bends> bends;

  explicit Passages(std::shared_ptr<const Bends> bends);  ///< nothing is leapt over
  Passages(std::shared_ptr<const Bends> bends, SpaceAhead empty);
};

}  // namespace sg::volume
