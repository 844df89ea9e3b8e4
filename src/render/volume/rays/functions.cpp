// SPDX-License-Identifier: Apache-2.0
#include "render/volume/rays/functions.h"

#include <algorithm>
#include <cmath>

namespace sg::volume {

namespace {

const size_t batch = 32;

template <class Better>
Found extreme(RayField& ray, Better better) {
  Found best;
  Stretch s[batch];
  for (size_t n; (n = ray.next(s)) > 0;)
    for (size_t i = 0; i < n; ++i) {
      const Stretch& p = s[i];
      // The hull bounds the cubic.
      bool hopeful = !best.found;
      for (float b : p.b) hopeful = hopeful || better(double(b), best.value);
      if (!hopeful) continue;
      double f[4] = {0, 0, 0, 1}, turn[2];
      const int inner = turns(p.b, turn);
      for (int k = 0; k < inner; ++k) f[k + 1] = turn[k];
      f[inner + 1] = 1;
      for (int k = 0; k < inner + 2; ++k) {
        const double v = bernstein(p.b, f[k]);
        if (v == v && (!best.found || better(v, best.value))) best = {v, p.from + f[k] * (p.to - p.from), true, 0, p.cell};
      }
    }
  return best;
}

}  // namespace

Found largest(RayField& ray) {
  return extreme(ray, [](double a, double b) { return a > b; });
}
Found smallest(RayField& ray) {
  return extreme(ray, [](double a, double b) { return a < b; });
}

Sum integral(RayField& ray) {
  Sum sum;
  Stretch s[batch];
  for (size_t n; (n = ray.next(s)) > 0;)
    for (size_t i = 0; i < n; ++i) {
      if (sum.length == 0) sum.first = s[i].from;
      const double length = s[i].to - s[i].from;
      sum.integral += length * 0.25 * (double(s[i].b[0]) + double(s[i].b[1]) + double(s[i].b[2]) + double(s[i].b[3]));
      sum.length += length;
    }
  return sum;
}

Found first_at_least(RayField& ray, double level) {
  Stretch s[batch];
  double first = HUGE_VAL;
  for (size_t n; (n = ray.next(s)) > 0;)
    for (size_t i = 0; i < n; ++i) {
      first = std::min(first, s[i].from);
      if (!(double(s[i].highest()) >= level)) continue;
      if (double(s[i].b[0]) >= level) return {double(s[i].b[0]), s[i].from, true, first, s[i].cell};
      double f[3];
      if (crossings(s[i].b, float(level), f) > 0) return {level, s[i].from + f[0] * (s[i].to - s[i].from), true, first, s[i].cell};
    }
  return {};
}

Sum length_at_least(RayField& ray, double level) {
  Sum sum;
  Stretch s[batch];
  for (size_t n; (n = ray.next(s)) > 0;)
    for (size_t i = 0; i < n; ++i) {
      if (!(double(s[i].highest()) >= level)) continue;
      double f[5] = {0};
      const int inner = crossings(s[i].b, float(level), f + 1);
      f[inner + 1] = 1;
      for (int k = 0; k <= inner; ++k) {
        if (!(bernstein(s[i].b, 0.5 * (f[k] + f[k + 1])) >= level)) continue;
        if (sum.length == 0) sum.first = s[i].from + f[k] * (s[i].to - s[i].from);
        sum.length += (f[k + 1] - f[k]) * (s[i].to - s[i].from);
      }
    }
  return sum;
}

namespace {

/// Calls f(crossing, stretch) from near to far while it returns true.
template <class F>
void each_crossing(RayField& ray, std::span<const double> levels, F&& f) {
  std::vector<Crossing> here;
  Stretch s[batch];
  double last_to = -HUGE_VAL;
  float last_value = 0;
  for (size_t n; (n = ray.next(s)) > 0;)
    for (size_t i = 0; i < n; ++i) {
      const Stretch& p = s[i];
      const bool joined = p.from - last_to <= 1e-9 * (1 + std::abs(p.from));
      here.clear();
      for (uint32_t l = 0; l < levels.size(); ++l) {
        const float level = float(levels[l]);
        // A jump over the level between neighbours; and a crossing exactly between them counts once, with the nearer one.
        const bool jump = joined && ((last_value < level && p.b[0] > level) || (last_value > level && p.b[0] < level));
        if (jump) here.push_back({p.from, l, {}, NAN});
        double at[3];
        const int count = crossings(p.b, level, at);
        for (int k = 0; k < count; ++k)
          if (!(at[k] == 0 && joined && last_value == level)) here.push_back({p.from + at[k] * (p.to - p.from), l, {}, NAN});
      }
      std::stable_sort(here.begin(), here.end(), [](const Crossing& a, const Crossing& b) { return a.t < b.t; });
      for (const Crossing& c : here)
        if (!f(c, p)) return;
      last_to = p.to, last_value = p.b[3];
    }
}

}  // namespace

void all_crossings(RayField& ray, std::span<const double> levels, std::vector<Crossing>& out) {
  out.clear();
  each_crossing(ray, levels, [&](const Crossing& c, const Stretch& s) {
    out.push_back({c.t, c.level, ray.gradient(s, c.t), ray.second(s, c.t)});
    return true;
  });
}

std::optional<Crossing> first_crossing(RayField& ray, std::span<const double> levels, double after) {
  std::optional<Crossing> first;
  each_crossing(ray, levels, [&](const Crossing& c, const Stretch&) {
    if (c.t > after) first = c;
    return !first;
  });
  return first;
}

}  // namespace sg::volume
