// SPDX-License-Identifier: Apache-2.0
// The voxels that draw something, by depth, and which of them touch which rows of the picture.
#pragma once
#include <cstdint>
#include <vector>

#include "render/volume/methods/footprint.h"

namespace sg::volume {

/// A voxel's share of the box (half for those in a face), value and position.
struct Splat {
  Vec3 q;
  float value, share;
};

class SplatList {
 public:
  static constexpr int band = 16;  ///< rows
  /// `classified`: only voxels whose own colour is seen; else all whose neighbourhood may be (or, in modes other than composite, all).
  SplatList(const Stage& stage, const Footprints& footprints, bool classified);

  size_t size() const { return voxels_.size(); }
  /// List indices of the voxels that touch a band of rows, nearest first.
  const uint32_t* begin(size_t b) const { return touching_.data() + start_[b]; }
  const uint32_t* end(size_t b) const { return touching_.data() + start_[b + 1]; }
  Splat splat(uint32_t place) const { return splat_of(voxels_[place]); }
  Vec3 q(uint32_t place) const { return lattice(voxels_[place]); }
  /// Lattice numbers of a voxel.
  Vec3 lattice(uint32_t voxel) const;

 private:
  void collect(bool classified);
  void sort(const Footprints& footprints);
  void bin(const Footprints& footprints);
  Splat splat_of(uint32_t voxel) const;
  float share(const size_t at[3]) const;

  const Stage& stage_;
  std::vector<float> axis_share_[3];
  std::vector<uint32_t> voxels_;  // sorted by depth
  std::vector<size_t> start_;
  std::vector<uint32_t> touching_;
};

}  // namespace sg::volume
