// SPDX-License-Identifier: Apache-2.0
// Triangles of plane areas with holes.
#pragma once
#include <cstdint>
#include <vector>

#include "base/vec.h"

namespace sg {

/// Triangulates the area between loops by ear clipping: a loop inside an odd number of others is a hole (even-odd), whatever its
/// direction. `loops` list places in `at`; loops must not cross, but may touch. Triangles are oriented like the outermost loop around them
/// and use every point of every loop, so that they match adjacent geometry: n + 2 h - 2 triangles for n points and h holes. Signs are exact
/// on a grid of 2^30 steps across the box; loops that cross still end, with triangles that overlap. Near O(n).
void triangulate_loops(const std::vector<Vec2>& at, const std::vector<std::vector<uint32_t>>& loops, std::vector<uint32_t>& triangles);

}  // namespace sg
