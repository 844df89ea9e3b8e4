// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/back_trace.h"

#include <algorithm>
#include <cmath>

namespace sg::texture {

namespace {

// The least squared distance of a stretch of a path to a place of dye.
void pass_dye(const PixelFlow& flow, const BackTrace& how, const double* from, const double* to, double& nearest) {
  const int d = flow.dimension();
  for (const Vec3& place : how.dye) {
    double a[3], w[3], ww = 0, aw = 0;
    for (int k = 0; k < d; ++k) {
      a[k] = (from[k] - place[k]) * how.pitch[k], w[k] = (to[k] - from[k]) * how.pitch[k];
      ww = ww + w[k] * w[k], aw = aw + a[k] * w[k];
    }
    const double t = ww > 0 ? std::min(std::max((0 - aw) / ww, 0.0), 1.0) : 0.0;
    double mm = 0;
    for (int k = 0; k < d; ++k) {
      const double m = a[k] + t * w[k];
      mm = mm + m * m;
    }
    nearest = std::min(nearest, mm);
  }
}

void trace_one(const PixelFlow& flow, const BackTrace& how, BackPath& p) {
  const int d = flow.dimension();
  const double half = how.h / 2, sixth = how.h / 6;
  pass_dye(flow, how, p.x, p.x, p.nearest);
  for (int64_t s = 0; s < how.steps; ++s) {
    double k[4][3] = {}, y[3];
    bool good = flow.at_nearest(p.x, k[0]);
    for (int stage = 1; stage < 4 && good; ++stage) {
      for (int a = 0; a < d; ++a) y[a] = p.x[a] + (stage == 3 ? how.h : half) * k[stage - 1][a];
      good = flow.at_nearest(y, k[stage]);
    }
    if (!good) return;
    bool moved = false;
    for (int a = 0; a < d; ++a) {
      const double step = sixth * (((k[0][a] + 2 * k[1][a]) + 2 * k[2][a]) + k[3][a]);
      y[a] = p.x[a] + step, moved = moved || step != 0;
    }
    pass_dye(flow, how, p.x, y, p.nearest);
    for (int a = 0; a < d; ++a) {
      // Rounding may carry a path that runs along the border a little out of it.
      const double most = flow.n(a) - 1;
      p.left = p.left || y[a] < -1e-6 || y[a] > most + 1e-6;
      p.x[a] = std::min(std::max(y[a], 0.0), most);
    }
    if (p.left || !moved) return;
  }
}

}  // namespace

void trace_back_scalar(const PixelFlow& flow, const BackTrace& how, BackPath* paths, size_t count) {
  for (size_t i = 0; i < count; ++i) trace_one(flow, how, paths[i]);
}

}  // namespace sg::texture
