// SPDX-License-Identifier: Apache-2.0
// Numbers for points that many cells name alike.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "base/huge_allocator.h"

namespace sg {

/// Name of a point on the edge between two mesh points: a in the upper half, b in the lower.
inline uint64_t edge_name(uint64_t a, uint64_t b) { return a << 32 | b; }

/// Distinct names in ascending order, and the place of each name among them.
struct CutNumbers {
  Plane<uint64_t> names;
  Plane<uint32_t> number;  ///< for the lists of names one after the other
};
/// Numbers what the chunks found, the same for any number of threads. Upper halves are below `points`. O(names), parallel.
CutNumbers number_names(const std::vector<std::span<const uint64_t>>& chunks, size_t points);

}  // namespace sg
