// SPDX-License-Identifier: Apache-2.0
#include "render/prepare/eye_view.h"

namespace sg::raster {

EyeView eye_view(const Projection& p, Vec3 origin) {
  EyeView v{};
  const Vec3 eye = p.eye - origin;
  for (int k = 0; k < 3; ++k) {
    v.hi[k] = float(eye[k]), v.lo[k] = float(eye[k] - double(v.hi[k]));
    v.right[k] = float(p.right[k]), v.up[k] = float(p.up[k]), v.forward[k] = float(p.forward[k]);
  }
  v.scale = float(p.scale), v.center_x = float(p.middle_x()), v.center_y = float(p.middle_y());
  v.near_plane = float(p.near_plane), v.far_plane = float(p.far_plane);
  v.parallel = p.parallel, v.width = p.width, v.height = p.height;
  return v;
}

}  // namespace sg::raster
