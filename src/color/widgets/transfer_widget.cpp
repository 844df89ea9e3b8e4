// SPDX-License-Identifier: Apache-2.0
#include "color/widgets/transfer_widget.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sg {

namespace {

// A polygon over (1 - x^2)^2: its tangents at 0, 1/4 and where it turns, and from there, where it bends the other way, chords.
constexpr Vec2 above_brush[] = {{0.1208, 1}, {0.3654, 0.7709}, {0.57735, 0.4445}, {0.85, 0.0771}, {1, 0}};

// The curve of one widget that is drawn by a brush: level over the line, or the middle of the ellipse.
OpacityCurve above(const TransferWidget& w) {
  const double radius = w.shape == TransferWidget::Shape::paint ? w.radius : 0.5 * (w.hi - w.lo);
  OpacityCurve curve{{{w.lo + radius, w.opacity}, {w.hi - radius, w.opacity}}};
  if (!(curve.points[0].x < curve.points[1].x)) curve.points.pop_back();
  for (const Vec2& p : above_brush) {
    curve.points.insert(curve.points.begin(), {p.x == 1 ? w.lo : w.lo + radius - p.x * radius, p.y * w.opacity});
    curve.points.push_back({p.x == 1 ? w.hi : w.hi - radius + p.x * radius, p.y * w.opacity});
  }
  return curve;
}

}  // namespace

TransferWidget painted(std::vector<Vec2> line, double radius, double second_radius, double opacity, Vec3f color) {
  TransferWidget w;
  w.shape = TransferWidget::Shape::paint, w.radius = radius, w.second_radius = second_radius, w.opacity = opacity, w.color = color;
  w.lo = w.hi = line.front().x, w.second_lo = w.second_hi = line.front().y;
  for (const Vec2& p : line) {
    w.lo = std::min(w.lo, p.x), w.hi = std::max(w.hi, p.x);
    w.second_lo = std::min(w.second_lo, p.y), w.second_hi = std::max(w.second_hi, p.y);
  }
  w.lo -= radius, w.hi += radius, w.second_lo -= second_radius, w.second_hi += second_radius;
  w.line = std::move(line);
  return w;
}

OpacityCurve bounding_curve(const std::vector<TransferWidget>& widgets) {
  std::vector<OpacityCurve> brushed;
  std::vector<double> knots;
  for (const TransferWidget& w : widgets) {
    if (w.brushed())
      for (const Vec2& p : brushed.emplace_back(above(w)).points) knots.push_back(p.x);
    else knots.insert(knots.end(), {w.lo, 0.5 * (w.lo + w.hi), w.hi});
  }
  std::sort(knots.begin(), knots.end());
  knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
  OpacityCurve curve;
  curve.points.clear();
  for (const double x : knots) {
    double most = 0;
    for (const TransferWidget& w : widgets)
      if (!w.brushed()) most = std::max(most, w.opacity * (1 - std::abs(x - 0.5 * (w.lo + w.hi)) / (0.5 * (w.hi - w.lo))));
    for (const OpacityCurve& c : brushed) most = std::max(most, c.at(x));
    curve.points.push_back({x, most});
  }
  return curve;
}

}  // namespace sg
