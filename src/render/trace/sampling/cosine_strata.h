// SPDX-License-Identifier: Apache-2.0
// Directions over a hemisphere by systematic sampling: one in each of a grid of strata of the square, at the same place in all.
#pragma once
#include <cstdint>

#include "render/trace/sampling/local_frame.h"

namespace sg::trace {

constexpr int cosine_strata_across = 4, cosine_strata_count = cosine_strata_across * cosine_strata_across;

/// Of stratum i (row by row) the unit vector frame.to_world(cosine_hemisphere((i % 4 + in.x) / 4, (i / 4 + in.y) / 4)). Bit i of the result
/// tells whether it is on the side that `above` points to. The same bytes for every width of vectors.
uint32_t cosine_strata(Vec2f in, const LocalFrame& frame, Vec3f above, Vec3f* directions);

}  // namespace sg::trace
