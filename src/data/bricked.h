// SPDX-License-Identifier: Apache-2.0
// BrickedVolume: a field on a uniform grid that need not fit into memory: read box by box, at several resolutions.
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "data/dataset.h"

namespace sg {

/// Made by a reader, immutable afterwards, used by any number of threads (docs/decisions/0004-bricked-volumes.md).
struct BrickedVolume {
  /// Samples lie at origin + direction * (spacing * (i,j,k)).
  struct Level {
    std::array<size_t, 3> dims{1, 1, 1};
    Vec3 origin{0, 0, 0}, spacing{1, 1, 1};
    std::array<size_t, 3> coarseness{1, 1,
                                     1};  ///< samples of level 0 per sample along each axis; each level's is a multiple of the one before
  };
  /// Of the values that are not NaN; lo > hi when there are none.
  struct Extremes {
    float lo, hi;
  };
  static constexpr size_t block = 64;  ///< cells along each axis per block of extremes

  std::string field, unit;
  ElementType type = ElementType::f32;
  Mat3 direction;             ///< columns: directions of the axes, orthonormal
  std::vector<Level> levels;  ///< 0 is the finest
  /// Of block (i,j,k) of level 0: samples 64i .. 64(i+1), both ends included, ...; x fastest, max(1, ceil((n-1)/64)) along an axis.
  /// Empty when the file does not give them.
  std::vector<Extremes> extremes;

  /// Fills `out` with the samples lo .. lo+count-1 of a level, packed, x fastest. The box must lie in the level. Starts no parallel
  /// loop. Throws Error(data) for what cannot be read.
  std::function<void(size_t level, std::array<size_t, 3> lo, std::array<size_t, 3> count, std::byte* out)> read;
  /// Tells the system that the box will soon be read. May be null.
  std::function<void(size_t level, std::array<size_t, 3> lo, std::array<size_t, 3> count)> expect;

  std::array<size_t, 3> blocks() const;
  /// Over all blocks; empty when the file does not give it.
  Range range() const;
  uint64_t bytes() const;  ///< of level 0
  /// Of the samples of level 0.
  Box3 bounds() const;
};
using BrickedPtr = std::shared_ptr<const BrickedVolume>;

/// Extremes of blocks, from slabs of whole slices that come one after the other.
class BlockExtremes {
 public:
  explicit BlockExtremes(std::array<size_t, 3> dims);
  /// The next `count` slices, packed, `components` numbers each of which component `component` counts. Parallel.
  void add(const Array& slab, int component, size_t count);
  std::vector<BrickedVolume::Extremes> take() { return std::move(extremes_); }

 private:
  std::array<size_t, 3> dims_, blocks_;
  size_t next_ = 0;
  std::vector<BrickedVolume::Extremes> extremes_;
};

}  // namespace sg
