// SPDX-License-Identifier: Apache-2.0
#include "render/volume/methods/slab_polygon.h"

#include <algorithm>
#include <cmath>

namespace sg::volume {

namespace {

double turn(Vec2 a, Vec2 b, Vec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

/// Andrew's monotone chain.
Polygon convex_hull(std::vector<Vec2> p) {
  std::sort(p.begin(), p.end(), [](Vec2 a, Vec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  p.erase(std::unique(p.begin(), p.end()), p.end());
  if (p.size() < 3) return p;
  Polygon hull(2 * p.size());
  size_t n = 0;
  for (size_t i = 0; i < p.size(); ++i) {
    while (n >= 2 && turn(hull[n - 2], hull[n - 1], p[i]) <= 0) --n;
    hull[n++] = p[i];
  }
  for (size_t i = p.size() - 1, lower = n + 1; i-- > 0;) {
    while (n >= lower && turn(hull[n - 2], hull[n - 1], p[i]) <= 0) --n;
    hull[n++] = p[i];
  }
  hull.resize(n - 1);
  return hull;
}

}  // namespace

Polygon slab_polygon(const Vec3 corners[8], double nearest, double farthest, const Projection& projection) {
  double depth[8];
  std::vector<Vec2> points;
  const auto add = [&](Vec3 world) {
    const Vec3 p = projection.to_pixel(world);
    points.push_back({p.x, p.y});
  };
  for (int c = 0; c < 8; ++c) {
    depth[c] = projection.to_eye(corners[c]).z;
    if (depth[c] >= nearest && depth[c] <= farthest) add(corners[c]);
  }
  for (int c = 0; c < 8; ++c)
    for (int axis = 0; axis < 3; ++axis) {
      const int d = c | 1 << axis;
      if (d == c) continue;
      for (const double plane : {nearest, farthest})
        if ((depth[c] < plane) != (depth[d] < plane)) {
          const double f = (plane - depth[c]) / (depth[d] - depth[c]);
          if (f >= 0 && f <= 1) add(lerp(corners[c], corners[d], f));
        }
    }
  return convex_hull(std::move(points));
}

void row_span(const Polygon& polygon, int y, int width, int& first, int& last) {
  // One hair wider than the row's middle line, so that rounding loses no pixel.
  const double lo = y + 0.5 - 1e-6, hi = y + 0.5 + 1e-6;
  double from = HUGE_VAL, to = -HUGE_VAL;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 a = polygon[i], b = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    if (std::max(a.y, b.y) < lo || std::min(a.y, b.y) > hi) continue;
    for (const double line : {lo, hi}) {
      const double f = a.y != b.y ? std::clamp((line - a.y) / (b.y - a.y), 0.0, 1.0) : 0;
      const double x = a.x + f * (b.x - a.x);
      from = std::min(from, x), to = std::max(to, x);
    }
    if (a.y == b.y) from = std::min(from, std::min(a.x, b.x)), to = std::max(to, std::max(a.x, b.x));
  }
  if (!(from <= to)) {
    first = last = 0;
    return;
  }
  first = int(std::clamp(std::floor(from - 0.5 - 1e-6), 0.0, double(width)));
  last = int(std::clamp(std::ceil(to - 0.5 + 1e-6) + 1, 0.0, double(width)));
}

}  // namespace sg::volume
