// SPDX-License-Identifier: Apache-2.0
// The return map of a line across a flow in the plane, and its fixed points: periodic orbits.
#pragma once
#include <algorithm>
#include <optional>
#include <vector>

#include "filter/flow/integrator.h"
#include "filter/flow/topology/mean_divergence.h"
#include "filter/flow/trace_line.h"

namespace sg {

/// A line across the flow: place(s) = origin + s along. `flow` is the unit direction of the flow at the origin, `reach` half its length.
struct Section {
  Vec3 origin, along, flow;
  double reach;
  Vec3 place(double s) const { return origin + s * along; }
};

struct Orbit {
  std::vector<Vec3> points;   ///< the first again at the end
  std::vector<double> speed;  ///< there
  double period = 0;
  double cell = 0;        ///< size of the cells there
  double multiplier = 1;  ///< of a small distance from the orbit, in one turn with the flow: < 1 attracts, > 1 repels
  bool resolved = true;   ///< the multiplier is more than the error of interpolation, see mean_growth()
};

struct ReturnOptions {
  double cell = 1;          ///< unit of lengths
  double tolerance = 1e-8;  ///< error of a step, in cells
  double longest_step = 1;  ///< in cells
  int64_t max_steps = 20000;
};

/// Follows the flow (`sign` -1: against it) from place(s) to where it crosses the section again in the same direction. Nothing when it
/// does not within the options. `path` receives the points on the way.
template <class Flow>
std::optional<double> next_return(Flow& flow, const Section& section, double s, double sign, const ReturnOptions& o, double& time,
                                  Orbit* path = nullptr) {
  Vec3 x = section.place(s), v;
  if (!flow(x, 0, v)) return std::nullopt;
  bool away = false;
  double h = 0;
  time = 0;
  if (path) path->points = {x}, path->speed = {length(v)};
  for (int64_t n = 0; n < o.max_steps; ++n) {
    const double speed = length(v);
    if (!(speed > 0)) return std::nullopt;
    const double longest = o.longest_step * o.cell / speed;
    h = h > 0 ? std::min(h, longest) : 0.1 * longest;
    DormandPrinceStep step;
    double error = 0;
    for (int tries = 0;; ++tries) {
      if (tries > 60) return std::nullopt;
      if (!dormand_prince_step(flow, x, 0, sign * h, v, step)) {
        h /= 2;
        continue;
      }
      error = length(step.error) / (o.tolerance * o.cell);
      if (error <= 1 || h < 1e-4 * longest) break;
      h = detail::next_step(h, error);
    }
    const double before = sign * dot(x - section.origin, section.flow), after = sign * dot(step.x1 - section.origin, section.flow);
    away = away || before < -0.1 * o.cell || length(x - section.origin) > 2 * section.reach;
    if (away && before < 0 && after >= 0) {
      // Where the dense output crosses: bisection, then the place along the section.
      double lo = 0, hi = 1;
      for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (lo + hi);
        (sign * dot(step.at(middle) - section.origin, section.flow) < 0 ? lo : hi) = middle;
      }
      const Vec3 hit = step.at(hi);
      const double at = dot(hit - section.origin, section.along);
      if (std::abs(at) <= section.reach) {
        time += hi * h;
        if (path) path->points.push_back(hit), path->speed.push_back(speed);
        return at;
      }
    }
    x = step.x1, v = step.k7, time += h;
    if (path) path->points.push_back(x), path->speed.push_back(length(v));
    h = detail::next_step(h, error);
  }
  return std::nullopt;
}

/// The integral over one turn of the flow's divergence, that of discs about the orbit with a radius of `cells` (their flux over their
/// area): the logarithm of the multiplier, but for the errors of interpolation. In a cell, the divergence of sampled flows is wrong to
/// first order in its size, with changing signs; across some cells it is not.
template <class Flow>
double mean_growth(Flow& flow, const Orbit& orbit, Vec3 normal, double cells) {
  double sum = 0, before = 0;
  for (size_t i = 0; i < orbit.points.size(); ++i) {
    double here = 0, cell = orbit.cell;  // next to walls, where discs do not fit, nothing is known
    if constexpr (requires { flow.cell_length(); }) {
      Vec3 v;
      if (flow(orbit.points[i], 0, v)) cell = std::max(cell, flow.cell_length());
    }
    for (const double radius : {cells * cell, 0.5 * cells * cell})
      if (const auto d = mean_divergence(flow, orbit.points[i], normal, radius)) {
        here = *d;
        break;
      }
    if (i > 0) {
      const double speed = 0.5 * (orbit.speed[i - 1] + orbit.speed[i]);
      if (speed > 0) sum += 0.5 * (before + here) * length(orbit.points[i] - orbit.points[i - 1]) / speed;
    }
    before = here;
  }
  return sum;
}

/// The periodic orbit near `start`, which a line followed with `sign` approaches: the secant method on the return map of the line across
/// the flow there, then bisection where it leaves. Orbits whose neighbours come nearer (or go) by less than `isolated` a turn are those of
/// a family about a centre: nothing, and `family` becomes true. Where the mean growth does not confirm it (half as much, or the opposite),
/// the orbit exists only because of the interpolation error: not resolved. `normal` is that of the plane.
template <class Flow>
std::optional<Orbit> periodic_orbit(Flow& flow, Vec3 start, Vec3 normal, double sign, const ReturnOptions& o, double isolated = 0.02,
                                    bool* family = nullptr) {
  Vec3 v;
  if (!flow(start, 0, v) || !(length(v) > 0)) return std::nullopt;
  Section section{start, normalize(cross(normal, v)), normalize(v), 8 * o.cell};
  double time = 0;
  auto difference = [&](double s) -> std::optional<double> {
    const auto back = next_return(flow, section, s, sign, o, time);
    if (!back) return std::nullopt;
    return *back - s;
  };
  double a = 0, b = 0;
  auto fa = difference(a);
  if (!fa) return std::nullopt;
  if (std::abs(*fa) < 1e-10 * o.cell) {
    b = a;
  } else {
    b = a + *fa;
    auto fb = difference(b);
    for (int round = 0;; ++round) {
      if (!fb || round > 40) return std::nullopt;
      if (std::abs(*fb) < 1e-9 * o.cell) break;
      // Where the steps meet the borders of cells, the map is smooth to their tolerance only.
      if (round > 8 && std::abs(*fb) < 100 * o.tolerance * o.cell) break;
      const double slope = (*fb - *fa) / (b - a);
      if (slope == 0 || !std::isfinite(slope)) return std::nullopt;
      double next = b - std::clamp(*fb / slope, -2 * o.cell, 2 * o.cell);
      if (std::abs(next) > section.reach) return std::nullopt;
      if (std::abs(next - b) < 1e-12 * o.cell) break;
      a = b, fa = fb, b = next, fb = difference(b);
    }
  }
  // How fast neighbours come nearer.
  const double aside = 0.05 * o.cell;
  const auto up = difference(b + aside), down = difference(b - aside);
  if (!up || !down) return std::nullopt;
  const double slope = 1 + (*up - *down) / (2 * aside);
  if (!(slope > -0.01)) return std::nullopt;  // lines of the plane do not change sides
  const double multiplier = std::max(slope, 0.0);
  if (std::abs(multiplier - 1) < isolated) {
    if (family) *family = true;
    return std::nullopt;
  }
  Orbit orbit;
  orbit.cell = o.cell;
  if (!next_return(flow, section, b, sign, o, orbit.period, &orbit)) return std::nullopt;
  orbit.points.back() = orbit.points.front(), orbit.speed.back() = orbit.speed.front();
  orbit.multiplier = sign > 0 ? multiplier : multiplier > 0 ? 1 / multiplier : HUGE_VAL;
  if (const double growth = std::log(orbit.multiplier); std::abs(growth) < 1) {
    for (const double cells : {1.5, 3.0}) orbit.resolved = orbit.resolved && mean_growth(flow, orbit, normal, cells) / growth > 0.5;
  }
  return orbit;
}

}  // namespace sg
