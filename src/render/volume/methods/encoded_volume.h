// SPDX-License-Identifier: Apache-2.0
// EncodedVolume: the voxels that are seen, as runs along scanlines of slices across one axis of the lattice.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "render/volume/methods/stage.h"

namespace sg::volume {

/// Lattice axes of a stack of slices.
struct SliceAxes {
  int i, j, k;  ///< along a scanline, from scanline to scanline, from slice to slice
};
inline SliceAxes slice_axes(int k) { return k == 0 ? SliceAxes{1, 2, 0} : k == 1 ? SliceAxes{0, 2, 1} : SliceAxes{0, 1, 2}; }

/// Classified, run-length encoded voxels (Lacroute, Levoy 1994).
struct EncodedVolume {
  struct Run {
    uint32_t begin, end;  ///< voxels of the scanline that are seen
  };
  struct Slice {
    std::vector<uint32_t> first_run, first_voxel;  ///< per scanline, and one more
    std::vector<Run> runs;
    std::vector<uint16_t> entry;   ///< of the transfer table
    std::vector<uint16_t> normal;  ///< direction of the gradient in the world (shaded only)
    std::vector<uint8_t> surface;  ///< how far there is a surface, of 255
  };
  SliceAxes axes{};
  std::vector<Slice> slices;
  size_t bytes() const;
};

/// Kept with the dataset as long as everything kept there stays below four times the volume.
std::shared_ptr<const EncodedVolume> encoded_volume(const Stage& stage, int axis);

/// Octahedral map of directions to 16 bits; opposite directions are distinguished.
uint16_t direction_code(Vec3f direction);
Vec3f direction_of(uint16_t code);

}  // namespace sg::volume
