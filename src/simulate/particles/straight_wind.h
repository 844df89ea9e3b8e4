// SPDX-License-Identifier: Apache-2.0
// A vector field in single precision on a uniform grid along x, y and z, at many places: the wind that most particles ask.
#pragma once
#include <array>
#include <cstddef>
#include <span>

#include "base/vec.h"

namespace sg::swarm {

struct StraightGrid {
  std::array<size_t, 3> dims{};  ///< at least 2 along each axis
  Vec3 origin, scale;            ///< scale: 1 / spacing
};

/// u = the trilinear interpolant of `values` (3 a point, x fastest) at x, computed in single precision along x, then y, then z; 0 outside
/// and where x is no number. The same bytes for any vector width.
void sample_straight(const StraightGrid& grid, const float* values, std::span<const Vec3> x, std::span<Vec3> u);

}  // namespace sg::swarm
