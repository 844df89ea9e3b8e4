// SPDX-License-Identifier: Apache-2.0
// ParticipatingMedium: a volume of the scene, on any kind of mesh, as light meets it.
#pragma once
#include <cstdint>
#include <vector>

#include "render/trace/media/collision.h"
#include "render/trace/tree/ray.h"
#include "render/volume/rays/cast.h"

namespace sg::trace {

/// How free paths and transmittances are found.
enum class Tracking {
  mixed,  ///< by majorants of bricks, and exactly in those that are dense or of meshes without bricks: unbiased
  exact,  ///< through every cell, by the integral of the extinction (regular tracking): the reference
  delta,  ///< by majorants alone, of bricks or cells (Woodcock et al. 1965; ratio tracking: Novak et al. 2014): unbiased
  march,  ///< fixed steps with one factor exp(-tau(middle) length) each: what textbooks show, of second order in the step
};

class ParticipatingMedium {
 public:
  /// `length`: of a world length in the units of the volume's item. `item`: number in the scene. `shown`: the range of the colours there.
  ParticipatingMedium(volume::CastVolume volume, uint32_t item, double length, Range shown);

  const volume::CastVolume& volume() const { return volume_; }
  const volume::DepthIntegral& depth() const { return depth_; }
  Tracking tracking() const { return tracking_; }
  void use(Tracking t) { tracking_ = t; }  ///< not march where the item has no step
  uint32_t item() const { return item_; }
  /// World box of what may be met.
  Box3 bounds() const;

  /// The ray in the volume's units, cut by the planes that clip it, and by `t_max`.
  volume::DepthRay inward(const Ray& ray, const Placement& placement) const;
  float outward(double t, const Placement& placement) const { return float(t / length_ * placement.scale); }

  /// What light meets at a place of this linear colour, where the field that colours has the value `coloring` (in the volume's units).
  Collision collision(Vec3f color, float coloring) const;
  /// The chance that a place with this extinction and gradient (world) is a surface.
  float surface(float tau, Vec3f gradient) const;

 private:
  Vec3f black_body_at(float coloring) const;

  volume::CastVolume volume_;
  volume::DepthIntegral depth_;
  PhaseFunction phase_;
  Tracking tracking_ = Tracking::mixed;
  uint32_t item_;
  double length_;
  // With black_body: what the values between the ends of the scale glow.
  double glow_lo_ = 0, glow_per_ = 0;
  std::vector<Vec3f> glow_;
};

}  // namespace sg::trace
