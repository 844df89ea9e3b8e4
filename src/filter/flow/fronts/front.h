// SPDX-License-Identifier: Apache-2.0
// Trajectories of a front that moves through a flow, level by level (Hultquist 1992; Garth et al. 2008).
#pragma once
#include <algorithm>
#include <vector>

#include "filter/flow/fronts/stream_surface.h"
#include "filter/flow/trace_line.h"

namespace sg {

/// Where a trajectory is at a level, and its number among the points of the surface.
struct FrontPoint {
  Vec3 x, v;
  double time = 0, arc = 0;
  int64_t number = -1;
};

/// From one place of the seed curve; at[k] belongs to level k. `ended`: its last point is where the flow ends, no full step from the one
/// before.
struct Trajectory {
  double s = 0;  ///< of the seed curve
  std::vector<FrontPoint> at;
  bool ended = false;
  int depth = 0;  ///< how often the gap was halved in which it was inserted
};

/// Moves the last point by `step` of length or time, in the direction `sign`, with errors below `tolerance` of a cell a step; appends the
/// point of the next level. Ends (once more appending where it got to) at the border and where the flow is slower than min_speed.
template <class Flow>
void advance(Flow& flow, Trajectory& path, FrontClock clock, double step, double sign, double tolerance, double min_speed, double t0) {
  FrontPoint p = path.at.back();
  p.number = -1;
  Vec3 v = p.v;
  double left = step, h = 0;
  flow(p.x, t0 + p.time, v);
  while (left > 1e-9 * step) {
    const double speed = length(v), cell = flow.cell_length();
    if (!(speed > min_speed)) {
      path.ended = true;
      break;
    }
    const double rate = clock == FrontClock::length ? speed : 1.0;  // of the clock a time
    const double rest = left / rate;
    if (!(h > 0)) h = std::min(rest, cell / speed);
    double dt = std::min(h, rest);
    DormandPrinceStep s;
    bool done = false;
    double error = 0;
    for (int n = 0; n < 40 && !done; ++n) {
      done = dormand_prince_step(flow, p.x, t0 + p.time, sign * dt, v, s);
      if (done) {
        error = length(s.error) / (tolerance * cell);
        if (error > 1 && dt * speed > 1e-4 * cell) dt = detail::next_step(dt, error), done = false;
      } else {
        dt /= 2;
        if (dt * speed < 1e-3 * std::min(cell, step * speed / rate)) break;
      }
    }
    if (!done) {
      path.ended = true;
      break;
    }
    const Vec3 to = flow.snap(s.x1);
    const double moved = length(to - p.x);
    if (clock == FrontClock::length && !(moved > 0)) {  // below the resolution of coordinates of this size
      path.ended = true;
      break;
    }
    p.x = to, v = s.k7, p.time += sign * dt, p.arc += sign * moved;
    left -= clock == FrontClock::length ? moved : dt;
    h = detail::next_step(dt, error);
  }
  p.v = v;
  path.at.push_back(p);
}

/// A closed or open row of trajectories (by number) at a level. torn[i]: the surface has a gap behind member i.
struct Front {
  std::vector<size_t> members;
  std::vector<uint8_t> torn;
};

/// Triangles between a front and the next: `below` and `above` are point numbers between two trajectories that both have, ends included;
/// the shorter diagonal each time. Orientation: along the front, then forward.
void stitch(const std::vector<int64_t>& below, const std::vector<int64_t>& above, const std::vector<Vec3>& points,
            std::vector<int64_t>& triangles);

}  // namespace sg
