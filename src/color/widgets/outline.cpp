// SPDX-License-Identifier: Apache-2.0
#include "color/widgets/outline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace sg {

namespace {

using std::numbers::pi;

using Lines = std::vector<std::vector<Vec2>>;

constexpr int round_pieces = 64;
constexpr double side_piece = 0.1;  // radii

double distance_to(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 d = b - a, from = p - a;
  const double squared = d.x * d.x + d.y * d.y;
  const double t = squared > 0 ? std::clamp((from.x * d.x + from.y * d.y) / squared, 0.0, 1.0) : 0;
  return std::hypot(from.x - t * d.x, from.y - t * d.y);
}

// Round a line by a brush of radius 1: the half circles and sides of all its segments, but what lies within another segment's reach.
class RoundLine {
 public:
  explicit RoundLine(std::vector<Vec2> line) : line_(std::move(line)) {}

  Lines around() const {
    Lines lines;
    for (size_t i = 0; i + 1 < line_.size(); ++i) {
      const Vec2 a = line_[i], b = line_[i + 1], d = b - a;
      const double length = std::hypot(d.x, d.y), turn = std::atan2(d.y, d.x);
      if (!(length > 0 && std::isfinite(length))) continue;
      const Vec2 normal{-d.y / length, d.x / length};
      const int pieces = int(std::clamp(std::ceil(length / side_piece), 1.0, 256.0));
      for (const double side : {1.0, -1.0}) keep(lines, i, pieces, [&](double k) { return a + d * (k / pieces) + normal * side; });
      for (const auto& [end, from] : {std::pair{a, turn + pi / 2}, std::pair{b, turn - pi / 2}})
        keep(lines, i, round_pieces / 2, [&](double k) {
          const double angle = from + pi * k / (round_pieces / 2);
          return end + Vec2{std::cos(angle), std::sin(angle)};
        });
    }
    return lines;
  }

 private:
  // The parts of a curve, in so many pieces, that no other segment reaches.
  template <class Place>
  void keep(Lines& lines, size_t own, int pieces, Place&& place) const {
    const auto free = [&](double t) { return !within_another(own, place(t)); };
    // Where that changes between two places.
    const auto border = [&](double from, double to) {
      const bool before = free(from);
      for (int i = 0; i < 12; ++i) (free(0.5 * (from + to)) == before ? from : to) = 0.5 * (from + to);
      return place(0.5 * (from + to));
    };
    bool joined = false;
    for (int k = 0; k < pieces; ++k) {
      const double middle = k + 0.5;
      const bool seen = free(middle);
      if (seen && !joined) lines.push_back({k > 0 ? border(middle - 1, middle) : free(0) ? place(0) : border(0, middle)});
      if (seen) lines.back().push_back(place(middle));
      if (!seen && joined) lines.back().push_back(border(middle - 1, middle));
      joined = seen;
    }
    if (joined) lines.back().push_back(free(pieces) ? place(pieces) : border(pieces - 0.5, pieces));
  }
  bool within_another(size_t own, Vec2 p) const {
    for (size_t i = 0; i + 1 < line_.size(); ++i)
      if (i != own && distance_to(p, line_[i], line_[i + 1]) < 1 - 1e-6) return true;
    return false;
  }

  std::vector<Vec2> line_;
};

Lines circle(Vec2 middle, double radius, double second_radius) {
  Lines lines(1);
  for (int k = 0; k <= round_pieces; ++k) {
    const double angle = 2 * pi * k / round_pieces;
    lines[0].push_back({middle.x + radius * std::cos(angle), middle.y + second_radius * std::sin(angle)});
  }
  return lines;
}

Lines around_paint(const TransferWidget& w) {
  // In radii, from the first point on.
  const Vec2 origin = w.line.front();
  std::vector<Vec2> line;
  for (const Vec2& p : w.line) {
    const Vec2 q{(p.x - origin.x) / w.radius, (p.y - origin.y) / w.second_radius};
    if (line.empty() || !(q == line.back())) line.push_back(q);
  }
  if (line.size() < 2) return circle(origin, w.radius, w.second_radius);
  Lines lines = RoundLine(line).around();
  for (auto& l : lines)
    for (Vec2& p : l) p = {origin.x + p.x * w.radius, origin.y + p.y * w.second_radius};
  return lines;
}

}  // namespace

Lines outline(const TransferWidget& w) {
  const double middle = 0.5 * (w.lo + w.hi);
  const Vec2 low{w.lo, w.second_lo}, right{w.hi, w.second_lo}, high{w.hi, w.second_hi}, left{w.lo, w.second_hi}, tip{middle, w.second_lo};
  switch (w.shape) {
    case TransferWidget::Shape::triangle: return {{tip, high}, {high, left}, {left, tip}};
    case TransferWidget::Shape::rectangle: return {{low, right}, {right, high}, {high, left}, {left, low}};
    case TransferWidget::Shape::ellipse:
      return circle({middle, 0.5 * (w.second_lo + w.second_hi)}, 0.5 * (w.hi - w.lo), 0.5 * (w.second_hi - w.second_lo));
    case TransferWidget::Shape::paint: return around_paint(w);
  }
  return {};
}

}  // namespace sg
