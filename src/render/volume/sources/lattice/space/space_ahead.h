// SPDX-License-Identifier: Apache-2.0
// How far a ray can leap through empty space, by the octant of its direction: what lies behind it does not shorten its leaps.
#pragma once
#include "base/vec.h"
#include "render/volume/sources/lattice/space/empty_space.h"
#include "scene/camera.h"

namespace sg::volume {

/// Directions of a picture's rays along each axis of a lattice.
struct Ways {
  std::array<bool, 3> down, up;  ///< down: or nowhere

  static Ways all() { return {{true, true, true}, {true, true, true}}; }
  /// `to_q` of the volume: from world lengths to its axes.
  static Ways of(const Projection& projection, const Mat3& to_q);
  size_t octants() const;
};

/// For each octant of `ways` and each fine brick a byte: 0 where it may draw something; n > 0: the cube of n^3 bricks that begins with it
/// and extends into the octant draws nothing (at most 15; beyond the lattice there is nothing). At least the distance of
/// distance_to_drawn().
struct SpaceAhead {
  Plane<uint8_t> bricks;        ///< and three bytes more, so that any can be read as a word
  std::array<int32_t, 3> up{};  ///< offset of the bytes of rays that go up an axis
  size_t octants = 1;

  SpaceAhead(const Distances& distance, const std::array<size_t, 3>& dims, const Ways& ways);
};

}  // namespace sg::volume
