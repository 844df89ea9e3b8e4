// SPDX-License-Identifier: Apache-2.0
// The factors of a shear-warp: which slices, how they are sheared and scaled, and what the intermediate picture covers.
#pragma once
#include "render/volume/methods/encoded_volume.h"
#include "render/volume/methods/options.h"

namespace sg::volume {

/// How the intermediate picture lies to the slices: voxel = scale(k) * pixel + shift(k) along i and j.
struct Factors {
  SliceAxes axes{};
  bool parallel = true, rising = true;  // slices from near to far have rising numbers
  double resolution = 1;                // pixels per voxel on the plane
  double plane = 0;                     // its k
  double shear_i = 0, shear_j = 0;      // parallel: voxels per slice
  Vec3 eye;                             // perspective: i, j, k of the eye
  double u0 = 0, v0 = 0;                // plane coordinates (in voxels) of pixel 0
  int width = 0, height = 0;

  double scale(double k) const { return (parallel ? 1 : (k - eye.z) / (plane - eye.z)) / resolution; }
  double shift_i(double k) const { return at_slice(u0, eye.x, shear_i, k); }
  double shift_j(double k) const { return at_slice(v0, eye.y, shear_j, k); }

 private:
  double at_slice(double on_plane, double e, double shear, double k) const {
    if (parallel) return on_plane + (k - plane) * shear;
    return e + (on_plane - e) * (k - eye.z) / (plane - eye.z);
  }
};

/// Coordinates along i, j, k.
inline Vec3 permuted(Vec3 q, const SliceAxes& a) { return {q[a.i], q[a.j], q[a.k]}; }

/// Throws Error(usage) for an eye inside the volume.
Factors factorise(const Stage& stage, const ShearWarpOptions& options);

}  // namespace sg::volume
