// SPDX-License-Identifier: Apache-2.0
// EyeView: a camera in f32, for vector code.
#pragma once
#include "scene/camera.h"

namespace sg::raster {

/// A camera over positions relative to one origin, in f32. The eye is split in two so that position - eye loses nothing.
struct EyeView {
  float hi[3], lo[3];
  float right[3], up[3], forward[3];
  float scale, center_x, center_y, near_plane, far_plane;
  bool parallel;
  int width, height;
};
EyeView eye_view(const Projection& p, Vec3 origin);

struct EyePoint {
  float x, y, z;
};
/// The same operations in the same order as the vector code, so that a clipped triangle meets its unclipped neighbours.
inline EyePoint to_eye(const EyeView& v, const float* p) {
  const float dx = (p[0] - v.hi[0]) - v.lo[0], dy = (p[1] - v.hi[1]) - v.lo[1], dz = (p[2] - v.hi[2]) - v.lo[2];
  return {dx * v.right[0] + dy * v.right[1] + dz * v.right[2], dx * v.up[0] + dy * v.up[1] + dz * v.up[2],
          dx * v.forward[0] + dy * v.forward[1] + dz * v.forward[2]};
}

}  // namespace sg::raster
