// SPDX-License-Identifier: Apache-2.0
#include "color/widgets/soft_stroke.h"

#include <algorithm>
#include <cmath>

namespace sg {

namespace {

constexpr double most_cells = 64;  // over either axis
// A cell counts as this much larger, of itself and of a radius: rounding may place a value in the one beside it.
constexpr double slack = 1e-3;

float falloff(float squared) { return squared < 1 ? (1 - squared) * (1 - squared) : 0; }

// Both take NaN, of numbers that floats cannot tell apart, for the first.
uint32_t cells_over(double radii) { return radii > 1 ? uint32_t(std::min(std::ceil(radii), most_cells)) : 1; }
uint32_t cell_at(float place, uint32_t count) { return place > 0 ? uint32_t(std::min(place, float(count - 1))) : 0; }

float per(double radius) { return float(std::min(1 / radius, 1e30)); }

}  // namespace

SoftStroke::SoftStroke(const std::vector<Vec2>& line, double radius, double second_radius, double base)
    : per_radius_(per(radius)), per_second_radius_(per(second_radius)) {
  Vec2 least = line.front(), most = line.front();
  for (size_t i = 0; i < line.size(); ++i) {
    const Vec2 p = line[i];
    least = {std::min(least.x, p.x), std::min(least.y, p.y)}, most = {std::max(most.x, p.x), std::max(most.y, p.y)};
    if (i + 1 == line.size() && i > 0) break;
    const Vec2 next = i + 1 < line.size() ? line[i + 1] : p;
    const double along = (next.x - p.x) / radius, up = (next.y - p.y) / second_radius, squared = along * along + up * up;
    segments_.push_back({float(p.x - base), float(p.y), float(along), float(up), squared > 0 ? float(1 / squared) : 0});
  }
  line_lo_ = float(least.x - base), line_hi_ = float(most.x - base);
  lo_ = float(least.x - radius - base), hi_ = float(most.x + radius - base);
  second_lo_ = float(least.y - second_radius), second_hi_ = float(most.y + second_radius);
  if (segments_.size() > 1) {
    columns_ = cells_over((most.x - least.x) / radius + 2), rows_ = cells_over((most.y - least.y) / second_radius + 2);
    sort_into_cells();
  }
}

// Seen from where the segment begins: differences of near values are exact.
float SoftStroke::squared(const Segment& s, float value, float second) const {
  const float x = (value - s.value) * per_radius_, y = (second - s.second) * per_second_radius_;
  const float t = std::clamp((x * s.along + y * s.up) * s.per_length_squared, 0.0f, 1.0f);
  const float dx = x - t * s.along, dy = y - t * s.up;
  return dx * dx + dy * dy;
}

void SoftStroke::sort_into_cells() {
  // Distances are in radii, from the corner of the bounds.
  const double per_x = double(per_radius_), per_y = double(per_second_radius_);
  const double width = (double(hi_) - double(lo_)) * per_x / columns_, height = (double(second_hi_) - double(second_lo_)) * per_y / rows_;
  per_column_ = float(per_x / width), per_row_ = float(per_y / height);
  const double reach = 0.5 * std::hypot(width, height) * (1 + slack) + 1 + slack;  // from a cell's middle to what paints in it
  std::vector<std::vector<uint32_t>> cells(size_t(columns_) * rows_);
  for (size_t i = 0; i < segments_.size(); ++i) {
    const Segment& s = segments_[i];
    const double x = (double(s.value) - double(lo_)) * per_x, y = (double(s.second) - double(second_lo_)) * per_y;
    const double along = double(s.along), up = double(s.up);
    const auto first = [&](double a, double b, double size, uint32_t n) { return cell_at(float((std::min(a, b) - reach) / size), n); };
    const auto last = [&](double a, double b, double size, uint32_t n) { return cell_at(float((std::max(a, b) + reach) / size), n); };
    for (uint32_t r = first(y, y + up, height, rows_); r <= last(y, y + up, height, rows_); ++r)
      for (uint32_t c = first(x, x + along, width, columns_); c <= last(x, x + along, width, columns_); ++c) {
        const double dx = (c + 0.5) * width - x, dy = (r + 0.5) * height - y;
        const double t = std::clamp((dx * along + dy * up) * double(s.per_length_squared), 0.0, 1.0);
        if (std::hypot(dx - t * along, dy - t * up) <= reach) cells[size_t(r) * columns_ + c].push_back(uint32_t(i));
      }
  }
  first_.push_back(0);
  for (const auto& cell : cells) {
    reach_.insert(reach_.end(), cell.begin(), cell.end());
    first_.push_back(uint32_t(reach_.size()));
  }
}

float SoftStroke::at(float value, float second) const {
  if (!(value > lo_ && value < hi_ && second > second_lo_ && second < second_hi_)) return 0;
  float least = 1;
  if (first_.empty()) {
    for (const Segment& s : segments_) least = std::min(least, squared(s, value, second));
    return falloff(least);
  }
  const size_t cell = size_t(cell_at((second - second_lo_) * per_row_, rows_)) * columns_ + cell_at((value - lo_) * per_column_, columns_);
  for (uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) least = std::min(least, squared(segments_[reach_[i]], value, second));
  return falloff(least);
}

float SoftStroke::most(float lo, float hi) const {
  if (!(lo < hi_ && hi > lo_)) return 0;
  const float off = std::max({line_lo_ - hi, lo - line_hi_, 0.0f}) * per_radius_;
  return falloff(off * off);
}

}  // namespace sg
