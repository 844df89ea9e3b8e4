// SPDX-License-Identifier: Apache-2.0
// One line of any flow: the loop over steps that all tracers share.
#pragma once
#include <algorithm>

#include "filter/flow/trace.h"

namespace sg {

namespace detail {

/// Steps in units of time: what `size` (in the options' unit) means at a speed in a cell.
inline double time_of(const TraceOptions& o, double size, double speed, double cell) {
  switch (o.unit) {
    case StepUnit::cells: return size * cell / speed;
    case StepUnit::length: return size / speed;
    default: return size;
  }
}

/// Size of the next step from its error (Hairer, Norsett, Wanner II.4), order 5.
inline double next_step(double h, double error) { return h * std::clamp(0.9 * std::pow(std::max(error, 1e-10), -0.2), 0.2, 5.0); }

/// Where a step passes the plane through `at` across `normal`: the place on the cubic with the velocities at both ends (times the step's
/// signed length), and how far along, in [0, 1].
inline Vec3 crossing(Vec3 x0, Vec3 x1, Vec3 m0, Vec3 m1, Vec3 at, Vec3 normal, double& f) {
  const auto place = [&](double s) {
    const double q = 1 - s;
    return (1 + 2 * s) * q * q * x0 + s * s * (3 - 2 * s) * x1 + s * q * q * m0 - s * s * q * m1;
  };
  double lo = 0, hi = 1;
  for (int n = 0; n < 40; ++n) {
    f = (lo + hi) / 2;
    (dot(place(f) - at, normal) < 0 ? lo : hi) = f;
  }
  return place(f);
}

/// Whether a scheme's steps, measured in length or cells, are steps in length: of dx/ds = v / |v|, the same curves as those of dx/dt = v.
/// Then all steps are as long as they should be, and none is longer near stagnation points. Adaptive steps watch their
/// error instead, and implicit ones keep the areas that time keeps.
inline bool by_length(const TraceOptions& o) {
  return o.unit != StepUnit::time && o.scheme != Scheme::dormand_prince && o.scheme != Scheme::implicit_midpoint;
}

/// The flow of dx/ds = v / |v| for one step of length l (signed) from t, where the speed is `speed`; takes down what time it needs.
template <class Flow>
struct AlongFlow {
  Flow& flow;
  Scheme scheme;
  double t, l, speed;
  double slowness[3] = {0, 0, 0};
  int stages = 0;
  bool operator()(Vec3 x, double, Vec3& v) {
    // Stages are half a step further, but for the last of Runge and Kutta's and that of Heun's.
    const double part = scheme == Scheme::heun || stages == 2 ? 1 : 0.5, slow = stages > 0 ? slowness[stages - 1] : 1 / speed;
    if (!flow(x, t + part * l * slow, v)) return false;
    const double s = length(v);
    slowness[stages++] = s > 0 ? 1 / s : 1 / speed;
    v = s > 0 ? v / s : Vec3();
    return true;
  }
  double time() const {
    const double first = 1 / speed;
    switch (scheme) {
      case Scheme::euler: return l * first;
      case Scheme::midpoint: return l * slowness[0];
      case Scheme::heun: return l / 2 * (first + slowness[0]);
      default: return l / 6 * (first + 2 * slowness[0] + 2 * slowness[1] + slowness[2]);
    }
  }
};

}  // namespace detail

/// Appends the points after the seed to `out`; the seed itself is there already as its last point, with velocity `v`. `sign` 1 or -1.
/// Times start at `t0` and lengths at 0. Returns why it ended.
template <class Flow>
StopReason trace_line(Flow& flow, double t0, double sign, const TraceOptions& o, TracedLines& out) {
  const Vec3 start = out.points.back(), start_v = out.velocity.back();
  Vec3 x = start, v = start_v;
  double t = t0, arc = 0, suggested = 0, drift = 0;
  const double first_cell = flow.cell_length();
  bool away = false;  // from the seed, so that coming back means something
  for (int64_t n = 0;; ++n) {
    if (n >= o.max_steps) return StopReason::steps;
    const double speed = length(v), cell = flow.cell_length();
    if (!(speed > o.min_speed)) return StopReason::speed;
    double h = suggested > 0 ? suggested : detail::time_of(o, o.step, speed, cell);
    if (o.scheme == Scheme::dormand_prince)
      h = std::clamp(h, detail::time_of(o, o.min_step, speed, cell), detail::time_of(o, o.max_step, speed, cell));
    const double left = std::min(o.max_time - std::abs(t - t0), (o.max_length - arc) / speed);
    if (!(left > 1e-9 * h)) return o.max_time - std::abs(t - t0) <= 1e-9 * h ? StopReason::time : StopReason::length;
    h = std::min(h, left);
    Vec3 next, next_v;
    bool done = false, at_border = false, in_length = detail::by_length(o);
    double took = 0;  // time
    double error = 0, step_error = 0;
    for (int halving = 0; halving <= 10 && !done; ++halving) {
      if (o.scheme == Scheme::dormand_prince) {
        DormandPrinceStep s;
        done = dormand_prince_step(flow, x, t, sign * h, v, s);
        if (done) {
          next = s.x1, next_v = s.k7;
          step_error = length(s.error);
          error = step_error / (o.tolerance * cell);
          if (error > 1 && h > detail::time_of(o, o.min_step, speed, cell) * 1.001) {
            h = std::max(detail::next_step(h, error), detail::time_of(o, o.min_step, speed, cell));
            done = false, --halving;
            continue;
          }
        }
      } else if (in_length) {
        const double l = sign * h * speed;
        detail::AlongFlow<Flow> along{flow, o.scheme, t, l, speed};
        done = fixed_step(o.scheme, along, x, t, l, v / speed, next) && flow(next, t + along.time(), next_v);
        took = std::abs(along.time());
        if (done && !(std::abs(t - t0) + took <= o.max_time)) {  // the last one ends in time
          in_length = done = false, --halving;
          h = std::min(h, o.max_time - std::abs(t - t0));
          continue;
        }
      } else {
        done = fixed_step(o.scheme, flow, x, t, sign * h, v, next) && flow(next, t + sign * h, next_v);
      }
      if (!done) at_border = true, h /= 2;
    }
    if (!done) return StopReason::outside;
    const Vec3 snapped = flow.snap(next);
    arc += length(snapped - x);
    if (!in_length) took = h;
    t += sign * took;
    // Back where it began: the step passes the plane through the seed across the flow, as close to the seed as the integration is exact.
    // What misses it by more is a spiral.
    drift += step_error;
    if (o.closed) {
      const Vec3 across = sign * start_v;
      const double before = dot(x - start, across), after = dot(snapped - start, across);
      away = away || length(snapped - start) > first_cell || dot(next_v, start_v) < 0;  // orbits may be smaller than large cells
      if (away && before < 0 && after >= 0 && length(snapped - start) < 2 * length(snapped - x)) {
        double f = 0;
        const double next_speed = length(next_v), h0 = sign * h, h1 = in_length && next_speed > 0 ? sign * h * speed / next_speed : h0;
        const Vec3 back = detail::crossing(x, snapped, h0 * v, h1 * next_v, start, across, f);
        const double miss =
            o.scheme == Scheme::dormand_prince ? std::clamp(drift, 1e-4 * first_cell, 1e-2 * first_cell) : 1e-3 * first_cell;
        if (length(back - start) < miss) {
          out.points.push_back(start), out.velocity.push_back(start_v);
          out.time.push_back(t - sign * took * (1 - f)), out.arc.push_back(arc - (1 - f) * length(snapped - x));
          return StopReason::closed;
        }
      }
    }
    x = snapped, v = next_v;
    out.points.push_back(x), out.velocity.push_back(v), out.time.push_back(t), out.arc.push_back(arc);
    if (o.scheme == Scheme::dormand_prince) suggested = detail::next_step(h, error);
    if (at_border && h < detail::time_of(o, o.min_step, speed, cell)) return StopReason::outside;
  }
}

}  // namespace sg
