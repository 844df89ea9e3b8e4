// SPDX-License-Identifier: Apache-2.0
#include "color/widgets/widget_regions.h"

#include <algorithm>

#include "color/cie.h"

namespace sg {

namespace {

// (1 - d^2)^2 is no more than this times 1 - d.
constexpr float steepest_brush = 32.0f / 27;

}  // namespace

WidgetRegions::WidgetRegions(const std::vector<TransferWidget>& widgets, double base) {
  for (const TransferWidget& w : widgets) {
    Region r;
    r.triangle = w.shape == TransferWidget::Shape::triangle;
    r.lo = float(w.lo - base), r.hi = float(w.hi - base), r.middle = float(0.5 * (w.lo + w.hi) - base);
    r.per_half = w.hi > w.lo ? float(2 / (w.hi - w.lo)) : 0;
    r.second_lo = float(w.second_lo), r.second_hi = float(w.second_hi);
    r.per_height = w.second_hi > w.second_lo ? float(1 / (w.second_hi - w.second_lo)) : 0;
    r.opacity = float(w.opacity);
    r.own_color = w.color.x >= 0 && w.color.y >= 0 && w.color.z >= 0;
    const Vec4f c = srgb_to_linear(Vec4f{w.color.x, w.color.y, w.color.z, 1});
    r.color = {c.x, c.y, c.z};
    r.narrow = 0.5f * (r.hi - r.lo), r.narrow_second = r.second_hi - r.second_lo;
    if (w.brushed()) {
      const bool paint = w.shape == TransferWidget::Shape::paint;
      const Vec2 half = paint ? Vec2{w.radius, w.second_radius} : Vec2{0.5 * (w.hi - w.lo), 0.5 * (w.second_hi - w.second_lo)};
      r.stroke = int(strokes_.size());
      const SoftStroke& s = strokes_.emplace_back(
          paint ? w.line : std::vector<Vec2>{{0.5 * (w.lo + w.hi), 0.5 * (w.second_lo + w.second_hi)}}, half.x, half.y, base);
      r.lo = s.lo(), r.hi = s.hi(), r.second_lo = s.second_lo(), r.second_hi = s.second_hi();
      r.narrow = float(half.x), r.narrow_second = float(half.y);
    }
    narrow_ = std::min(narrow_, r.narrow);
    if (r.second_hi > r.second_lo) narrow_second_ = std::min(narrow_second_, r.narrow_second);
    widgets_.push_back(r);
  }
}

float WidgetRegions::at(float value, float second, const Vec4f& plain, float* color) const {
  float most = 0, sum = 0;
  Vec3f mixed{0, 0, 0};
  for (const Region& w : widgets_) {
    // What is on a side shows nothing, whatever rounding makes of its distance from the middle: clear() counts on that.
    if (!(second >= w.second_lo && second <= w.second_hi && value > w.lo && value < w.hi)) continue;
    float share = 0;
    if (w.stroke >= 0) {
      share = strokes_[size_t(w.stroke)].at(value, second);
    } else {
      float from_middle = std::abs(value - w.middle) * w.per_half;
      if (w.triangle) {
        const float height = (second - w.second_lo) * w.per_height;  // width 0 at the base point, hi - lo at the top
        if (!(from_middle < height)) continue;
        from_middle /= height;
      }
      share = 1 - from_middle;
    }
    const float a = w.opacity * share;
    if (!(a > 0)) continue;
    most = std::max(most, a), sum += a;
    mixed = mixed + (w.own_color ? w.color : Vec3f{plain.x, plain.y, plain.z}) * a;
  }
  if (color && sum > 0) color[0] = mixed.x / sum, color[1] = mixed.y / sum, color[2] = mixed.z / sum;
  return most;
}

bool WidgetRegions::clear(float lo, float hi) const {
  return std::all_of(widgets_.begin(), widgets_.end(), [&](const Region& w) { return w.opacity == 0 || hi <= w.lo || lo >= w.hi; });
}

float WidgetRegions::most(float lo, float hi) const {
  float most = 0;
  for (const Region& w : widgets_) {
    if (w.stroke >= 0) {
      most = std::max(most, w.opacity * strokes_[size_t(w.stroke)].most(lo, hi));
      continue;
    }
    const float off = std::max({w.lo > hi ? 1.0f : 0.0f, lo > w.middle ? (lo - w.middle) * w.per_half : 0.0f,
                                hi < w.middle ? (w.middle - hi) * w.per_half : 0.0f});
    most = std::max(most, w.opacity * std::max(0.0f, 1 - off));
  }
  return most;
}

bool WidgetRegions::misses(float lo, float hi, float apart) const {
  return std::any_of(widgets_.begin(), widgets_.end(), [&](const Region& w) { return w.narrow < apart && w.lo <= hi && w.hi >= lo; });
}

bool WidgetRegions::misses_second(float lo, float hi, float apart) const {
  return std::any_of(widgets_.begin(), widgets_.end(),
                     [&](const Region& w) { return w.narrow_second < apart && w.second_lo <= hi && w.second_hi >= lo; });
}

std::vector<OpacityEdge> WidgetRegions::edges() const {
  std::vector<OpacityEdge> all;
  for (const Region& w : widgets_) {
    const float steep = w.stroke >= 0 ? w.opacity * steepest_brush / w.narrow : w.triangle ? HUGE_VALF : w.opacity * w.per_half;
    for (const float at : {w.lo, w.hi}) all.push_back({at, steep});
  }
  return all;
}

std::vector<OpacityEdge> WidgetRegions::second_edges() const {
  std::vector<OpacityEdge> all;
  for (const Region& w : widgets_) {
    const float steep = w.stroke >= 0 ? w.opacity * steepest_brush / w.narrow_second : HUGE_VALF;
    for (const float at : {w.second_lo, w.second_hi}) all.push_back({at, steep});
  }
  return all;
}

}  // namespace sg
