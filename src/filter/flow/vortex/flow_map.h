// SPDX-License-Identifier: Apache-2.0
// Where a flow carries places in a given time: the map behind FTLE, advected images and coherent structures.
#pragma once
#include <algorithm>

#include "filter/flow/integrator.h"
#include "filter/flow/trace.h"

namespace sg {

struct Carried {
  Vec3 to;
  double time = 0;      ///< how long it was carried; less than asked for (in size) when it left the flow
  bool inside = false;  ///< there was a velocity at the start
};

/// From x at t0 over `duration` (negative: back in time) by Dormand and Prince's pair; the error of each step is below `tolerance` times
/// the cell's size. Ends early where the flow ends, a thousandth of a step before.
template <class Flow>
Carried carry(Flow& flow, Vec3 x, double t0, double duration, double tolerance, int64_t max_steps = 1000000) {
  Carried out{x, 0, false};
  const double sign = duration < 0 ? -1 : 1, all = std::abs(duration);
  Vec3 v;
  if (!flow(x, t0, v)) return out;
  out.inside = true;
  const double speed = length(v), cell = flow.cell_length();
  double h = speed > 0 ? std::min(all, 0.5 * cell / speed) : all / 16, done = 0;
  for (int64_t n = 0; n < max_steps && done < all;) {
    h = std::min(h, all - done);
    DormandPrinceStep s;
    if (!dormand_prince_step(flow, x, t0 + sign * done, sign * h, v, s)) {
      h /= 2;
      if (h < 1e-3 * all / 64 && h * length(v) < 1e-3 * flow.cell_length()) break;
      if (h < 1e-12 * all) break;
      continue;
    }
    ++n;
    const double error = length(s.error) / (tolerance * flow.cell_length());
    const double next = h * std::clamp(0.9 * std::pow(std::max(error, 1e-10), -0.2), 0.2, 5.0);
    if (error > 1 && h > 1e-10 * all) {
      h = next;
      continue;
    }
    x = s.x1, v = s.k7, done += h;
    if (all - done < 1e-13 * all) done = all;
    h = next;
  }
  out.to = x, out.time = sign * done;
  return out;
}

}  // namespace sg
