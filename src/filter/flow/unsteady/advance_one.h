// SPDX-License-Identifier: Apache-2.0
// One particle through one interval, in any flow.
#pragma once
#include "filter/flow/trace_line.h"
#include "filter/flow/unsteady/particles.h"

namespace sg::detail {

/// A particle that starts: on the mesh and with a velocity, or ended.
template <class Flow>
bool start_particle(Flow& flow, Particle& p) {
  p.x = flow.snap(p.x);
  p.started = flow(p.x, p.t, p.v);
  p.ended = !p.started;
  return p.started;
}

/// See advance(); `record(particle)` after each step. The particle has started, and the flow's last answer was at its place and time.
template <class Flow, class Record>
void advance_one(Flow& flow, Particle& p, double until, const TraceOptions& o, Record&& record) {
  const bool adapts = o.scheme == Scheme::dormand_prince;
  const double sign = until >= p.t ? 1 : -1, tiny = 1e-12 * std::max(std::abs(until), std::abs(until - p.t));
  while (!p.ended) {
    const double left = std::abs(until - p.t);
    if (!(left > tiny)) {
      p.t = until;
      return;
    }
    if (p.steps >= o.max_steps) {
      p.ended = true, p.why = StopReason::steps;
      return;
    }
    const double speed = length(p.v), cell = flow.cell_length(), least = time_of(o, o.min_step, speed, cell);
    double h = p.next > 0 ? p.next : time_of(o, o.step, speed, cell);
    if (adapts) h = std::clamp(h, least, time_of(o, o.max_step, speed, cell));
    const double wished = h;
    // Two even steps rather than a long and a short one.
    if (!(h < left)) h = left;
    else if (adapts && h > left / 2) h = left / 2;
    Vec3 x, v;
    double error = 0;
    bool done = false, at_border = false;
    for (int halving = 0; halving <= 10 && !done; ++halving) {
      if (adapts) {
        DormandPrinceStep s;
        done = dormand_prince_step(flow, p.x, p.t, sign * h, p.v, s);
        if (done) {
          error = length(s.error) / (o.tolerance * cell);
          if (error > 1 && h > 1.001 * std::min(least, left)) {
            h = std::max(next_step(h, error), std::min(least, left));
            done = false, --halving;
            continue;
          }
          x = s.x1, v = s.k7;
        }
      } else {
        done = fixed_step(o.scheme, flow, p.x, p.t, sign * h, p.v, x) && flow(x, p.t + sign * h, v);
      }
      if (!done) at_border = true, h /= 2;
    }
    if (!done) {
      p.ended = true, p.why = StopReason::outside;
      return;
    }
    p.x = flow.snap(x), p.v = v;
    p.t = h >= left ? until : p.t + sign * h;
    ++p.steps;
    // A step cut short by the end of the interval says little about the next.
    if (adapts) p.next = h < wished && error <= 1 ? std::max(wished, next_step(h, error)) : next_step(h, error);
    record(p);
    if (at_border && h < least) p.ended = true, p.why = StopReason::outside;
  }
}

}  // namespace sg::detail
