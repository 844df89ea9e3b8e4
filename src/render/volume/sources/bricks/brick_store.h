// SPDX-License-Identifier: Apache-2.0
// Bricks in memory: the numbers of one leaf of the tree, with a margin for interpolation and gradients.
#pragma once
#include <memory>
#include <vector>

#include "data/bricked.h"
#include "data/memory/byte_cache.h"
#include "render/volume/sources/bricks/brick_lattice.h"
#include "render/volume/sources/bricks/brick_tree.h"

namespace sg::volume {

/// Samples of one level around a box, in their own type (64-bit and 32-bit whole numbers as f32).
struct BrickData {
  static constexpr int small = 8;  ///< cells along an axis of a little cube whose range is known
  struct Cube {
    float lo, hi;  ///< of the values that are not NaN; lo > hi when there are none
  };
  Array values;
  std::array<int, 3> n{};         ///< samples held
  std::array<double, 3> first{};  ///< sample index of the first one in its level
  std::array<double, 3> most{};   ///< last sample index of the level
  std::array<int, 3> cubes{};
  std::vector<Cube> cube;
  /// Fills the 8 corners of the cell of samples at, at + step (x fastest).
  void (*corners)(const std::byte* values, size_t at, const size_t step[3], float out[8]) = nullptr;

  /// Central differences over two samples at a place in that cell (0..1 along each axis), per sample. All samples next to the cell must be
  /// held.
  void (*differences)(const std::byte* values, size_t at, const size_t step[3], const float place[3], float out[3]) = nullptr;

  size_t bytes() const { return values.bytes() + cube.size() * sizeof(Cube); }
};

/// Identifies a brick by one number.
inline uint64_t brick_key(size_t level, const std::array<uint32_t, 3>& at) {
  return uint64_t(level) << 57 | uint64_t(at[2]) << 38 | uint64_t(at[1]) << 19 | at[0];
}

/// Sample index v = u * scale + shift of a level, from fine coordinates u.
void level_places(const BrickedVolume& volume, size_t level, Vec3& scale, Vec3& shift);

/// Samples of a level around a box in fine coordinates, one more on each side than interpolation needs.
struct SampleBox {
  std::array<size_t, 3> from{}, count{};
};
SampleBox samples_around(const BrickedVolume& volume, size_t level, Vec3 lo, Vec3 hi);
/// Reads them, in the type of the volume (64-bit and 32-bit whole numbers and f64 as f32). Starts no parallel loop.
Array read_samples(const BrickedVolume& volume, size_t level, const SampleBox& box);

/// Reads the brick that covers the box lo..hi (fine coordinates) at a level. Starts no parallel loop.
std::shared_ptr<const BrickData> load_brick(const BrickedVolume& volume, size_t level, Vec3 lo, Vec3 hi);

/// What is kept with the dataset for the next picture.
struct BrickCaches {
  ByteCache<BrickData> bricks{0};
  ByteCache<BrickLattice> lattices{0};
};
std::shared_ptr<BrickCaches> brick_caches(const Dataset& dataset);

}  // namespace sg::volume
