// SPDX-License-Identifier: Apache-2.0
// Random widgets of all shapes, and what they are by definition.
#pragma once
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "color/widgets/transfer_widget.h"
#include "support/property.h"

namespace sg::test {

/// Over lo..hi and second_lo..second_hi, somewhat beyond them at times.
inline TransferWidget random_widget(Random& random, Vec2 lo, Vec2 hi) {
  using Shape = TransferWidget::Shape;
  const Vec2 all = hi - lo;
  const auto place = [&] { return Vec2{lo.x + all.x * random.in(-0.1, 1.1), lo.y + all.y * random.in(-0.1, 1.1)}; };
  const double opacity = random.chance(0.1) ? 0 : random.unit();
  const Vec3f color = random.chance(0.5) ? Vec3f{-1, -1, -1} : Vec3f{float(random.unit()), float(random.unit()), float(random.unit())};
  const Shape shape = random.one_of({Shape::triangle, Shape::rectangle, Shape::ellipse, Shape::paint});
  if (shape == Shape::paint) {
    const auto radius = [&] { return random.magnitude(0.003, 0.5); };
    std::vector<Vec2> line;
    const int points = random.chance(0.2) ? 1 : random.whole(2, 30);
    for (int i = 0; i < points; ++i)
      line.push_back(i > 0 && random.chance(0.5) ? line.back() + Vec2{all.x * random.in(-0.1, 0.1), all.y * random.in(-0.1, 0.1)}
                                                 : place());
    if (random.chance(0.2)) line.push_back(line.back());
    return painted(std::move(line), all.x * radius(), all.y * radius(), opacity, color);
  }
  TransferWidget w;
  const Vec2 a = place(), size{all.x * random.magnitude(0.01, 1), all.y * random.magnitude(0.01, 1)};
  w.shape = shape, w.opacity = opacity, w.color = color;
  w.lo = a.x, w.hi = a.x + size.x, w.second_lo = a.y, w.second_hi = a.y + size.y;
  return w;
}

/// Distance to a painted line in radii of the brush, from every one of its segments.
inline double brush_distance(const TransferWidget& w, double value, double second) {
  double least = INFINITY;
  for (size_t i = 0; i < w.line.size(); ++i) {
    const Vec2 a = w.line[i], b = w.line[std::min(i + 1, w.line.size() - 1)];
    const Vec2 d{(b.x - a.x) / w.radius, (b.y - a.y) / w.second_radius}, p{(value - a.x) / w.radius, (second - a.y) / w.second_radius};
    const double squared = d.x * d.x + d.y * d.y, t = squared > 0 ? std::clamp((p.x * d.x + p.y * d.y) / squared, 0.0, 1.0) : 0;
    least = std::min(least, std::hypot(p.x - t * d.x, p.y - t * d.y));
  }
  return least;
}

inline double opacity_by_definition(const TransferWidget& w, double value, double second) {
  using Shape = TransferWidget::Shape;
  const double middle = 0.5 * (w.lo + w.hi), half = 0.5 * (w.hi - w.lo), off = std::abs(value - middle) / half;
  const auto soft = [](double d) { return d < 1 ? (1 - d * d) * (1 - d * d) : 0; };
  const bool inside = second >= w.second_lo && second <= w.second_hi;
  switch (w.shape) {
    case Shape::rectangle: return inside ? w.opacity * std::max(0.0, 1 - off) : 0;
    case Shape::triangle: {
      const double height = (second - w.second_lo) / (w.second_hi - w.second_lo);
      return inside && off < height ? w.opacity * (1 - off / height) : 0;
    }
    case Shape::ellipse:
      return w.opacity * soft(std::hypot(off, (second - 0.5 * (w.second_lo + w.second_hi)) / (0.5 * (w.second_hi - w.second_lo))));
    case Shape::paint: return w.opacity * soft(brush_distance(w, value, second));
  }
  return 0;
}

/// A place where a widget shows all of its opacity.
inline Vec2 strongest(const TransferWidget& w, Random& random) {
  if (w.shape == TransferWidget::Shape::paint) return w.line[size_t(random.whole(0, int(w.line.size()) - 1))];
  const double middle = 0.5 * (w.lo + w.hi);
  if (w.shape == TransferWidget::Shape::ellipse) return {middle, 0.5 * (w.second_lo + w.second_hi)};
  return {middle, w.second_hi};
}

}  // namespace sg::test
