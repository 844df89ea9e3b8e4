// SPDX-License-Identifier: Apache-2.0
// The source behind bricked_source(): the tree of a view, and the bricks that it needs.
#pragma once
#include <mutex>

#include "render/volume/sources/bricks/brick_lattice.h"
#include "render/volume/sources/bricks/brick_store.h"
#include "render/volume/sources/bricks/bricked_source.h"

namespace sg::volume {

/// Where levels lie.
struct BrickPlaces {
  Mat3 to_fine;                    ///< world -> fine coordinates, after taking the origin off
  Mat3 to_world;                   ///< gradients: value per sample of level 0 -> per world length
  Vec3 lo, hi;                     ///< the grid in fine coordinates
  std::vector<Vec3> scale, shift;  ///< per level: sample index from fine coordinates
};

class BrickedSource final : public RaySource {
 public:
  BrickedSource(BrickedPtr volume, DatasetPtr data, const Projection& projection, size_t memory, double coarser);

  std::unique_ptr<RayField> walker() const override;
  /// Made when it is first asked for; needs `invisible`.
  const BrickTree& tree() const;
  const BrickedVolume& volume() const { return *volume_; }
  const BrickPlaces& places() const { return places_; }
  /// How many bricks a walker may hold besides the cache.
  size_t pins() const { return pins_; }

  std::shared_ptr<const BrickData> brick(size_t level, const std::array<uint32_t, 3>& at) const;
  /// Gives most of the memory to lattices instead of bricks.
  void expect_lattices() const;
  /// A leaf of the tree as a lattice of the values that are drawn in it.
  std::shared_ptr<const BrickLattice> lattice(const BrickNode& node) const;

 private:
  void foresee() const;
  double finest_edge() const;

  BrickedPtr volume_;
  DatasetPtr data_;
  Projection projection_;
  double pixels_;
  size_t cache_limit_ = 0, pins_ = 4;
  uint64_t most_bytes_ = 0;  // of the bricks of a picture
  std::shared_ptr<BrickCaches> caches_;
  BrickPlaces places_;
  mutable bool in_lattices_ = false;
  mutable std::once_flag planned_;
  mutable std::unique_ptr<BrickTree> tree_;
};

}  // namespace sg::volume
