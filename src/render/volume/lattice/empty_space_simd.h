// SPDX-License-Identifier: Apache-2.0
// The inner loops of distance_to_drawn(): rows of bricks as bits.
#pragma once
#include <cstdint>

#include "index/minmax_bricks.h"

namespace sg::volume {

/// A transfer function as a table: how many entries before each one draw something. Entry of a value: int((value - first) * per_axis) + 1,
/// clamped; `last` is the entry for what lies above.
struct DrawnEntries {
  float first, per_axis, last;
  const uint32_t* drawn_before;  ///< of entries 0 .. last + 1
};

/// Bit i of `bits` says whether ranges[i] may draw something (one entry more to each side, for rounding errors); a range without values
/// draws nothing. `distance` gets 0 where it does and `otherwise` where not. Whole words of bits are written.
void find_drawn(const MinMaxBricks::Range* ranges, size_t n, const DrawnEntries& entries, uint8_t otherwise, uint64_t* bits,
                uint8_t* distance);

/// distance[i] = level where bit i is set.
void write_level(const uint64_t* bits, size_t n, uint8_t level, uint8_t* distance);

}  // namespace sg::volume
