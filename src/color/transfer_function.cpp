// SPDX-License-Identifier: Apache-2.0
#include "color/transfer_function.h"

#include <bit>

#include "base/error.h"
#include "color/cie.h"

namespace sg {

namespace {

constexpr int table_size = 4096;
constexpr float not_even = -1;  ///< alpha of an entry of a table on which the colour jumps or is steep: it is asked of the scale

// log2 with straight lines between the powers of two: monotone, continuous, exactly invertible. 0 for 1.
float bit_log(float v) { return float(std::bit_cast<int32_t>(v) - 0x3F800000) * 0x1p-23f; }
double bit_exp(double a) {
  return double(std::bit_cast<float>(int32_t(std::clamp(std::lround(a * 0x1p23), -0x3F800000L, 0x3FFFFFFFL)) + 0x3F800000));
}

const OpacityCurve& checked(const OpacityCurve& c) {
  if (c.points.empty()) fail_usage("the opacity curve has no points", "opacity", "write position:opacity pairs, e.g. 0:0,0.3:0.1,1:0.8");
  return c;
}

}  // namespace

FastCurve::FastCurve(const OpacityCurve& curve, double base) {
  for (const Vec2& p : checked(curve).points) x_.push_back(float(p.x - base)), y_.push_back(float(p.y));
  const size_t n = x_.size();
  slope_.assign(n, 0);
  positive_before_.assign(n + 1, 0);
  for (size_t i = 0; i + 1 < n; ++i) {
    slope_[i] = x_[i + 1] > x_[i] ? (y_[i + 1] - y_[i]) / (x_[i + 1] - x_[i]) : 0;
    positive_before_[i + 1] = positive_before_[i] + (y_[i] > 0 || y_[i + 1] > 0);
  }
  positive_before_[n] = positive_before_[n - 1];
  const float width = x_.back() - x_.front();
  first_.assign(width > 0 ? 1024 : 1, 0);
  per_slice_ = width > 0 ? float(first_.size()) / width : 0;
  if (!std::isfinite(per_slice_)) per_slice_ = 0;
  // The interval in which a slice begins; one early, lest rounding of the slice's number starts a search too late.
  size_t i = 0;
  for (size_t s = 0; s < first_.size() && per_slice_ > 0; ++s) {
    const float begin = x_.front() + float(s) / per_slice_;
    while (i + 2 < n && x_[i + 1] <= begin) ++i;
    first_[s] = uint32_t(i);
  }
  for (size_t s = first_.size(); s-- > 1;) first_[s] = first_[s - 1];
}

size_t FastCurve::after(float x) const { return size_t(std::upper_bound(x_.begin(), x_.end(), x) - x_.begin()); }

bool FastCurve::zero(float lo, float hi) const {
  if (!(lo <= hi)) return false;
  const size_t a = after(lo), b = after(hi), n = x_.size();
  if (a == 0 && y_.front() > 0) return false;
  if (b == n && y_.back() > 0) return false;
  const size_t first = a == 0 ? 0 : a - 1, last = std::min(b, n - 1);  // intervals [first, last)
  return last <= first || positive_before_[last] == positive_before_[first];
}

float FastCurve::most(float lo, float hi) const {
  float most = std::max(at(lo), at(hi));
  const size_t a = size_t(std::lower_bound(x_.begin(), x_.end(), lo) - x_.begin()), b = after(hi);
  for (size_t i = a; i < b; ++i) most = std::max(most, y_[i]);
  return most;
}

float FastCurve::narrow() const {
  float least = HUGE_VALF;
  for (size_t i = 0; i + 1 < x_.size(); ++i)
    if (x_[i + 1] > x_[i]) least = std::min(least, x_[i + 1] - x_[i]);
  return least;
}

bool FastCurve::shorter_line(float lo, float hi, float length) const {
  if (!(lo <= hi)) return true;  // NaN: nothing is known
  size_t i = after(lo);
  for (i = i > 0 ? i - 1 : 0; i + 1 < x_.size() && x_[i] <= hi; ++i)
    if (x_[i + 1] > x_[i] && x_[i + 1] - x_[i] < length && x_[i + 1] >= lo) return true;
  return false;
}

std::vector<FastCurve::Edge> FastCurve::edges() const {
  std::vector<Edge> all;
  for (size_t i = 0; i + 1 < x_.size(); ++i) {
    if (x_[i + 1] == x_[i]) {
      if (y_[i + 1] != y_[i]) all.push_back({x_[i], HUGE_VALF});
    } else if (y_[i] == 0 && y_[i + 1] > 0) {
      all.push_back({x_[i], slope_[i]});
    } else if (y_[i] > 0 && y_[i + 1] == 0) {
      all.push_back({x_[i + 1], -slope_[i]});
    }
  }
  return all;
}

TransferFunction::Colors::Colors(const ColorScale& s, double b) : scale(s), base(b) {
  const ColorTable ends = color_table(s, 2);
  below = ends.below, above = ends.above, nan = ends.nan;
  if (!s.labels.empty()) return;
  if (s.kind == ScaleKind::symlog) {
    const double most = std::max(std::abs(s.lo), std::abs(s.hi));
    const double threshold = s.linear_threshold > 0 ? s.linear_threshold : most > 0 ? 1e-3 * most : 1;
    per_threshold = float(1 / threshold);
  }
  const double lo = double(axis(float(s.lo - b))), hi = double(axis(float(s.hi - b)));
  first = float(lo);
  per_axis = hi > lo ? float(table_size / (hi - lo)) : 0;
  for (int i = 0; i < table_size; ++i)
    table.push_back(srgb_to_linear(
        s.color(std::clamp(value_on_axis(lo + (hi - lo) * (i + 0.5) / table_size), std::min(s.lo, s.hi), std::max(s.lo, s.hi)))));
  const auto mark = [&](int i) { table[size_t(std::clamp(i, 0, table_size - 1))].w = not_even; };
  const std::vector<Vec4f> plain = table;
  for (size_t i = 0; i + 1 < plain.size(); ++i)
    if (std::max({std::abs(plain[i].x - plain[i + 1].x), std::abs(plain[i].y - plain[i + 1].y), std::abs(plain[i].z - plain[i + 1].z)}) >
        0.01f)
      mark(int(i)), mark(int(i) + 1);
}

float TransferFunction::Colors::axis(float v) const {
  if (scale.kind == ScaleKind::linear) return v;
  const float absolute = float(double(v) + base);
  if (scale.kind == ScaleKind::log) return absolute > 0 ? bit_log(absolute) : -1e30f;
  const float m = bit_log(1 + std::abs(absolute) * per_threshold);
  return absolute < 0 ? -m : m;
}

double TransferFunction::Colors::value_on_axis(double a) const {
  if (scale.kind == ScaleKind::linear) return a + base;
  if (scale.kind == ScaleKind::log) return bit_exp(a);
  return std::copysign((bit_exp(std::abs(a)) - 1) / double(per_threshold), a);
}

Vec4f TransferFunction::Colors::at(float v) const {
  if (v != v) return nan;
  if (!scale.labels.empty()) return srgb_to_linear(scale.color(double(v) + base));
  const float place = (axis(v) - first) * per_axis;
  if (place >= 0 && place <= float(table_size)) {
    const Vec4f& c = table[size_t(std::min(int(place), table_size - 1))];
    return c.w == not_even
               ? srgb_to_linear(scale.color(std::clamp(double(v) + base, std::min(scale.lo, scale.hi), std::max(scale.lo, scale.hi))))
               : c;
  }
  return place < 0 ? below : above;
}

TransferFunction::TransferFunction(const ColorScale& scale, const OpacityCurve& opacity, const TransferDetail& detail, double base)
    : colors_(scale, base), curve_(opacity, base), factor_(detail.second_factor, 0), widgets_(detail.widgets, base) {
  color_by_second_ = detail.color_by_second;
  if (color_by_second_) {
    if (detail.second == SecondAxis::none) fail_usage("colour follows the second axis, but there is no second axis", "transfer function");
    second_colors_.emplace_back(detail.second_color, 0);
  }
  const auto& factors = detail.second_factor.points;
  with_factor_ = detail.second != SecondAxis::none && !std::all_of(factors.begin(), factors.end(), [](Vec2 p) { return p.y == 1; });
  most_factor_ = with_factor_ ? factor_.most(-HUGE_VALF, HUGE_VALF) : 1;
  drawn_lo_ = scale.clamp ? -HUGE_VALF : float(std::min(scale.lo, scale.hi) - base);
  drawn_hi_ = scale.clamp ? HUGE_VALF : float(std::max(scale.lo, scale.hi) - base);
  if (!scale.clamp) edges_ = {{drawn_lo_, HUGE_VALF}, {drawn_hi_, HUGE_VALF}};
  if (widgets_.empty()) {
    narrow_ = curve_.narrow();
    const std::vector<Edge> more = curve_.edges();
    edges_.insert(edges_.end(), more.begin(), more.end());
    if (with_factor_) narrow_second_ = factor_.narrow(), second_edges_ = factor_.edges();
  } else {
    narrow_ = widgets_.narrow(), narrow_second_ = widgets_.narrow_second();
    const std::vector<Edge> more = widgets_.edges();
    edges_.insert(edges_.end(), more.begin(), more.end());
    second_edges_ = widgets_.second_edges();
  }
}

bool TransferFunction::misses(float lo, float hi, float apart) const {
  if (!(apart > narrow_)) return false;
  if (widgets_.empty()) return curve_.shorter_line(lo, hi, apart);
  return widgets_.misses(lo, hi, apart);
}

bool TransferFunction::misses_second(float lo, float hi, float apart) const {
  if (!(apart > narrow_second_)) return false;
  if (widgets_.empty()) return factor_.shorter_line(lo, hi, apart);
  return widgets_.misses_second(lo, hi, apart);
}

float TransferFunction::opacity_and_color(float value, float second, float color[4]) const {
  const Vec4f c = color_by_second_ ? second_colors_[0].at(second) : colors_.at(value);
  color[0] = c.x, color[1] = c.y, color[2] = c.z, color[3] = c.w;
  if (!(value >= drawn_lo_ && value <= drawn_hi_) || c.w == 0) return 0;
  if (!widgets_.empty()) return widgets_.at(value, second, c, color);
  const float opacity = curve_.at(value);
  return with_factor_ ? opacity * factor_.at(second) : opacity;
}

bool TransferFunction::clear(float lo, float hi) const {
  if (!(lo <= hi)) return false;
  lo = std::max(lo, drawn_lo_), hi = std::min(hi, drawn_hi_);
  if (lo > hi) return true;
  if (!widgets_.empty()) return widgets_.clear(lo, hi);  // whatever the factor
  return most_factor_ == 0 || curve_.zero(lo, hi);
}

float TransferFunction::most_opacity(float lo, float hi) const {
  if (clear(lo, hi)) return 0;
  if (widgets_.empty()) return curve_.most(lo, hi) * most_factor_;
  return widgets_.most(lo, hi);
}

}  // namespace sg
