// SPDX-License-Identifier: Apache-2.0
// A leaf of the tree as a lattice of its own, with a margin: what packets of rays draw (engines/packets/packets.h).
#pragma once
#include "data/bricked.h"
#include "render/volume/sources/bricks/brick_tree.h"
#include "render/volume/sources/lattice/lattice_volume.h"

namespace sg::volume {

/// Samples of one level around a leaf. Where the leaf blends into the next coarser level, the two are mixed at the samples.
struct BrickLattice {
  LatticeSamples samples;  ///< voxels and the ranges of fine bricks; at least two samples along each axis
  Vec3 first;              ///< index of sample 0 in its level
  size_t bytes() const { return samples.voxels.array.bytes() + samples.fine.size() * sizeof(MinMaxBricks::Range); }
};

/// Starts no parallel loop. Throws what reading throws.
std::shared_ptr<const BrickLattice> load_lattice(const BrickedVolume& volume, const BrickTree& tree, const BrickNode& leaf);

/// Identifies a lattice by one number; for volumes of at most 2^17 bricks and 32 levels.
inline uint64_t lattice_key(const BrickNode& n) {
  return uint64_t(n.level) << 59 | uint64_t(n.at[2]) << 42 | uint64_t(n.at[1]) << 25 | uint64_t(n.at[0]) << 8 | n.blend;
}

/// What of it one medium leaves empty.
struct BrickSpace {
  Distances distance;  ///< as distance_to_drawn()
  bool any_empty = false, nothing = false;
};
BrickSpace space_of(const FineBricks& fine, const Invisible& invisible);

}  // namespace sg::volume
