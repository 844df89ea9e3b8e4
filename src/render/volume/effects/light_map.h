// SPDX-License-Identifier: Apache-2.0
// LightMap: how much of the light of a distant lamp arrives at each place of a volume (single scattering).
#pragma once
#include <cstdint>
#include <vector>

#include "base/context.h"
#include "render/volume/medium/optical_depth.h"

namespace sg::volume {

/// Transmittance exp(-integral of tau towards the lamp) on a lattice that is turned to the light: one axis runs along the rays of light,
/// and each of its rows is one ray, integrated through the cells of the volume without steps. Nothing is interpolated on the way, unlike
/// in sweeps from slice to slice, which smear shadows; reading it trilinearly is of second order in the spacing. (Volumetric shadows as
/// a map in light space: Behrens, Ratering 1998; half-angle slices: Kniss et al. 2003.)
///
///   lamp  \ \ \ \ \       rows along the light, spacing h in all three axes
///          \.\.\.\.\      kept as 16 bits: right to 1/131070
///           \.\.\.\.\     .
class LightMap {
 public:
  struct Plan {
    double spacing = 0;                     ///< world length; 0 = the smallest edge of a cell
    size_t most_samples = size_t(1) << 23;  ///< 2 bytes each; the spacing grows until this many suffice
  };
  /// `towards` is the direction to the lamp. Clipped parts cast no shadow.
  LightMap(const RaySource& source, Extinction extinction, const std::vector<ClipPlane>& clip, Vec3 towards, const Plan& plan,
           const Context* context = nullptr);

  /// Share of the light that arrives at a point in world space, 0..1: behind the volume what it transmits, outside its shadow all.
  float at(Vec3 place) const;

  /// The samples as they lie, the last axis fastest, and where a place is along an axis in them (not clamped).
  struct Samples {
    const uint16_t* values;  ///< 65535 = all light
    const size_t* n;
  };
  Samples samples() const { return {values_.data(), n_}; }
  double coordinate(int axis, Vec3 place) const { return (dot(axis_[axis], place) - first_[axis]) * per_length_[axis]; }

  double spacing() const { return spacing_; }
  size_t bytes() const { return values_.size() * sizeof(uint16_t); }

 private:
  Vec3 axis_[3], first_;  // unit axes (the last along the light), and the place of sample 0 by them
  double spacing_ = 1;
  Vec3 per_length_;
  size_t n_[3] = {2, 2, 2};
  std::vector<uint16_t> values_;  // the last axis fastest
};

}  // namespace sg::volume
