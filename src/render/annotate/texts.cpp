// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/texts.h"

#include <algorithm>
#include <cmath>

namespace sg {

namespace {

constexpr double half_turn = 3.14159265358979323846;

// Squares along a turned text: what it covers, near enough to keep texts apart.
std::vector<Rect> squares(Vec2 center, double angle, TextExtent e) {
  const double side = e.height, c = std::cos(angle), s = -std::sin(angle);  // rows count downwards
  const int n = std::max(1, int(std::ceil(e.width / side)));
  std::vector<Rect> rects;
  for (int i = 0; i < n; ++i) {
    const double along = n > 1 ? (double(i) / (n - 1) - 0.5) * (e.width - side) : 0;
    rects.push_back({center.x + along * c - 0.5 * side, center.y + along * s - 0.5 * side, side, side});
  }
  return rects;
}

}  // namespace

double text_angle(const TextItem& t, const Projection& p) {
  const Vec3 d{dot(t.along, p.right), dot(t.along, p.up), dot(t.along, p.forward)}, e = p.to_eye(t.at);
  // How x and y of the picture change along the direction, but for a positive factor.
  const double x = p.parallel ? d.x : d.x - d.z * e.x / e.z, y = p.parallel ? d.y : d.y - d.z * e.y / e.z;
  if (x * x + y * y < 1e-6 * dot(t.along, t.along) || !(dot(t.along, t.along) > 0)) return 0;
  const double angle = std::atan2(y, x), slack = 1e-9;
  return angle > half_turn / 2 + slack ? angle - half_turn : angle <= -half_turn / 2 + slack ? angle + half_turn : angle;
}

void draw_texts(Overlay& o, const std::vector<TextItem>& texts, const Projection& p, double font, std::vector<Rect>& taken) {
  for (const TextItem& t : texts) {
    const Vec3 at = p.to_pixel(t.at);
    if (!p.parallel && !(at.z > 0)) continue;
    TextStyle style;
    style.size = font * t.size;
    style.rim = 0.35;
    const std::string text = typeset_number(t.text);
    const double angle = text_angle(t, p);
    const std::vector<Rect> rects = squares({at.x, at.y}, angle, o.measure(text, style));
    const auto blocked = [&](const Rect& r) {
      if (r.x < 1 || r.y < 1 || r.right() > p.width - 1 || r.bottom() > p.height - 1) return true;
      return std::any_of(taken.begin(), taken.end(), [&](const Rect& other) { return other.overlaps(r); });
    };
    if (std::any_of(rects.begin(), rects.end(), blocked)) continue;
    o.text_turned(text, {at.x, at.y}, angle, style, t.color ? &*t.color : nullptr);
    taken.insert(taken.end(), rects.begin(), rects.end());
  }
}

}  // namespace sg
