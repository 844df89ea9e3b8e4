// SPDX-License-Identifier: Apache-2.0
// The inner loops of distance_to_drawn(): bricks as bits.
#pragma once
#include <cstddef>
#include <cstdint>

#include "index/minmax_bricks.h"

namespace sg::volume {

/// The values that draw something, on a linear axis: (value - first) * per_axis lies in one of the runs [from, to].
struct DrawnRuns {
  static constexpr int most = 8;
  float first = 0, per_axis = 1;
  int count = 0;
  float from[most], to[most];
};

/// Bit i of `bits` says whether ranges[i] meets a run; a range without values does not. Whole words are written.
void find_drawn(const MinMaxBricks::Range* ranges, size_t n, const DrawnRuns& runs, uint64_t* bits);

/// Rows of bricks as bits, the next row `row` words on, the next layer `layer` words on, with at least one zero between any two rows.
struct BitLattice {
  size_t row, layer;
  const uint64_t* used;  ///< the bits that are bricks
};
/// Words at once of widen(): `begin` and `end` are multiples of it, and as many words may be read beyond each side of a row and a layer.
constexpr size_t widen_words = 8;
/// For the words begin .. end: to = every bit of `from` and its 26 neighbours. New bits are set in the `planes` too. Returns whether
/// there is anything new.
bool widen(const BitLattice& lattice, const uint64_t* from, size_t begin, size_t end, uint64_t* to, uint64_t* const* planes,
           int plane_count);

constexpr int distance_planes = 4;
/// distance[i]: bit p is that of planes[p]; 15 where bit i of `reached` is not set.
void write_distances(const uint64_t* const* planes, const uint64_t* reached, size_t n, uint8_t* distance);

}  // namespace sg::volume
