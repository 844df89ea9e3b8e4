// SPDX-License-Identifier: Apache-2.0
// Poincare indices from velocities around a place, without a look at where they vanish.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "base/vec.h"

namespace sg {

/// How often the vectors turn counter-clockwise on the way around a loop, from each to the next by less than half a turn; exact for a
/// field that is linear on each side. Nothing when a vector is zero or two neighbours are opposite.
std::optional<int> winding_index(std::span<const Vec2> loop);

/// How often the directions of the vectors at the corners of closed triangles (three places in `v` each, counter-clockwise from outside)
/// cover the sphere; exact for a field that is linear on each triangle. Nothing when a vector is zero. Sum of solid angles / 4 pi
/// (van Oosterom, Strackee 1983).
std::optional<int> covering_index(std::span<const Vec3> v, std::span<const std::array<uint32_t, 3>> triangles);

}  // namespace sg
