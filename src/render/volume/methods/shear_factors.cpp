// SPDX-License-Identifier: Apache-2.0
#include "render/volume/methods/shear_factors.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "base/error.h"

namespace sg::volume {

Factors factorise(const Stage& s, const ShearWarpOptions& options) {
  const Volume& v = s.volume;
  const Vec3 centre = s.world((v.lo + v.hi) * 0.5), along = v.to_q * s.sight(centre), eye = v.q(s.projection.eye);
  int best = -1;
  for (int a = 0; a < 3; ++a) {
    // The eye must see all slices from one side.
    if (!s.projection.parallel && eye[a] > v.lo[a] - 0.1 && eye[a] < v.hi[a] + 0.1) continue;
    if (best < 0 || std::abs(along[a]) > std::abs(along[best])) best = a;
  }
  if (best < 0)
    fail_usage("method=shear_warp cannot look from inside the volume", "camera", "move the camera out of the volume, or use method=ray");
  Factors f;
  f.axes = slice_axes(best), f.parallel = s.projection.parallel;
  const Vec3 l = permuted(along, f.axes), lo = permuted(v.lo, f.axes), hi = permuted(v.hi, f.axes);
  f.eye = permuted(eye, f.axes);
  f.rising = f.parallel ? l.z > 0 : f.eye.z < lo.z;
  const double top = double(v.voxels.dims[size_t(f.axes.k)] - 1), near = f.rising ? 0 : top, far = top - near;
  f.plane = near;
  f.resolution = options.resolution;
  if (f.parallel) f.shear_i = l.x / l.z, f.shear_j = l.y / l.z;
  else f.resolution *= std::clamp((far - f.eye.z) / (near - f.eye.z), 1.0, 4.0);  // far slices keep their voxels, within reason
  // What the box covers on the plane.
  double u[2] = {HUGE_VAL, -HUGE_VAL}, w[2] = {HUGE_VAL, -HUGE_VAL};
  for (const double k : {near, far})
    for (const Vec3& c : {lo, hi}) {
      double i = c.x, j = c.y;
      if (f.parallel) i -= (k - f.plane) * f.shear_i, j -= (k - f.plane) * f.shear_j;
      else {
        const double r = (f.plane - f.eye.z) / (k - f.eye.z);
        i = f.eye.x + (i - f.eye.x) * r, j = f.eye.y + (j - f.eye.y) * r;
      }
      u[0] = std::min(u[0], i), u[1] = std::max(u[1], i), w[0] = std::min(w[0], j), w[1] = std::max(w[1], j);
    }
  const double margin = 1e-9 + 1 / f.resolution;
  f.u0 = u[0] - margin, f.v0 = w[0] - margin;
  // In whole steps from the lattice, so that the nearest slice meets its voxels.
  f.u0 = std::floor(f.u0 * f.resolution) / f.resolution, f.v0 = std::floor(f.v0 * f.resolution) / f.resolution;
  const double across = (u[1] - f.u0) * f.resolution + 3, down = (w[1] - f.v0) * f.resolution + 3;
  if (!(across < 30000 && down < 30000))
    fail_usage(fmt::format("method=shear_warp would need an intermediate picture of {:.0f} x {:.0f}", across, down), "volume",
               "use method=ray, which needs none");
  f.width = int(across), f.height = int(down);
  return f;
}

}  // namespace sg::volume
