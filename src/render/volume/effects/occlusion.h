// SPDX-License-Identifier: Apache-2.0
// Occlusion: how much of the light from all around is hidden from a place by matter near it.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/context.h"
#include "render/volume/medium/optical_depth.h"

namespace sg::volume {

/// On a lattice over the box of the volume, the share that is hidden in each of six directions: the pyramid on a face of a cube, from
/// half a cell to `radius` away. Its shell from s to 2s counts with the opacity of a box of edge s, read trilinearly in the middle of the
/// shell (so that a little of what lies up to 1.5 radius away counts too); boxes of all sizes come from a pyramid of opacities (one per
/// axis: behind each other they multiply, side by side they add). In a homogeneous medium the share is 1 - exp(-tau (radius - cell/2))
/// exactly. Opacity, not extinction, is what is averaged: half of a box filled with stone hides half. (Cones through pyramids: Crassin et
/// al. 2011; six directions blended by the squares of the normal: McTaggart 2004.)
class Occlusion {
 public:
  /// Cell = radius / 16, or 1/8, 1/4 while that is not below half of the smallest edge of the mesh: at most 1.5 million cells whatever
  /// the mesh, 12 bytes each.
  struct Plan {
    double radius = 0;  ///< world length; 0 = 1/12 of the diagonal
  };
  Occlusion(const RaySource& source, Extinction extinction, const std::vector<ClipPlane>& clip, const Plan& plan,
            const Context* context = nullptr);

  /// Share hidden from a place: the mean of the six directions, or as far as there is a surface (0..1) that of the side to which `normal`
  /// (unit) points: sum of n_a^2 hidden(direction a).
  float hidden(Vec3 place, Vec3f normal, float surface) const;

  double cell() const { return cell_; }
  double radius() const { return radius_; }
  size_t bytes() const { return hidden_.size() * sizeof(hidden_[0]); }

 private:
  using Six = std::array<uint16_t, 6>;  // -x, +x, -y, +y, -z, +z
  Vec3 first_;                          // middle of cell 0
  double cell_ = 1, radius_ = 1;
  size_t n_[3] = {1, 1, 1};
  std::vector<Six> hidden_;
};

}  // namespace sg::volume
