// SPDX-License-Identifier: Apache-2.0
#include "color/color_scale.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"
#include "color/cie.h"

namespace sg {
namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

double threshold_of(const ColorScale& s) {
  if (s.linear_threshold > 0) return s.linear_threshold;
  const double largest = std::max(std::abs(s.lo), std::abs(s.hi));
  return largest > 0 ? 1e-3 * largest : 1;
}

/// v/threshold near zero, one more per decade beyond it; continuous at the threshold.
double symlog(double v, double threshold) {
  const double a = std::abs(v) / threshold;
  return a <= 1 ? v / threshold : std::copysign(1 + std::log10(a), v);
}
double symlog_inverse(double y, double threshold) {
  const double a = std::abs(y);
  return a <= 1 ? y * threshold : std::copysign(threshold * std::pow(10.0, a - 1), y);
}

/// Maps of a range so small that one value fills it: the middle, or outside.
double flat_position(double v, double lo) { return v == lo ? 0.5 : v < lo ? -1 : 2; }

/// Halves first: hi - lo may overflow.
double linear_position(double v, double lo, double hi) {
  const double range = hi - lo;
  return std::isfinite(range) ? (v - lo) / range : (0.5 * v - 0.5 * lo) / (0.5 * hi - 0.5 * lo);
}

/// Place of a label, or the number of labels. Data often holds labels as float, so rounding to float still matches.
size_t label_place(const std::vector<double>& labels, double v) {
  const auto same = [v](double l) { return l == v || float(l) == float(v); };
  const size_t near = size_t(std::lower_bound(labels.begin(), labels.end(), v) - labels.begin());
  for (size_t i : {near, near - 1})
    if (i < labels.size() && labels[i] == v) return i;
  for (size_t i = 0; i < labels.size(); ++i)
    if (labels[i] == v) return i;
  for (size_t i = 0; i < labels.size(); ++i)
    if (same(labels[i])) return i;
  return labels.size();
}

Vec4f opaque(Vec3f c) { return {c.x, c.y, c.z, 1}; }

}  // namespace

double ColorScale::position(double v) const {
  if (v != v) return no_value;
  if (!labels.empty()) {
    const size_t i = label_place(labels, v);
    return i < labels.size() ? (double(i) + 0.5) / double(labels.size()) : no_value;
  }
  if (kind == ScaleKind::log && !(lo > 0 && hi > 0)) return no_value;
  if (kind == ScaleKind::log && !(v > 0)) return lo <= hi ? -1 : 2;  // below every decade
  if (lo == hi) return flat_position(v, lo);
  double t;
  if (kind == ScaleKind::log) {
    // Of ratios: the same for all powers of two of a field.
    const double at = v / lo, all = hi / lo;
    const bool exact = at > 0 && all > 0 && std::isfinite(at) && std::isfinite(all) && all != 1;
    t = exact ? std::log(at) / std::log(all) : linear_position(std::log(v), std::log(lo), std::log(hi));
  } else if (kind == ScaleKind::symlog) {
    const double c = threshold_of(*this);
    t = linear_position(symlog(v, c), symlog(lo, c), symlog(hi, c));
  } else {
    return linear_position(v, lo, hi);
  }
  // Rounding of the logarithm must not push a value across an end of the range.
  const bool inside = lo < hi ? v >= lo && v <= hi : v <= lo && v >= hi;
  return inside ? std::clamp(t, 0.0, 1.0) : t;
}

double ColorScale::value_at(double t) const {
  if (t != t) return no_value;
  if (!labels.empty()) {
    if (t < 0 || t > 1) return no_value;
    return labels[std::min(labels.size() - 1, size_t(t * double(labels.size())))];
  }
  if (t == 0) return lo;
  if (t == 1) return hi;
  if (kind == ScaleKind::log) {
    if (!(lo > 0 && hi > 0)) return no_value;
    const double all = hi / lo;
    return all > 0 && std::isfinite(all) ? lo * std::pow(all, t) : std::exp(std::log(lo) * (1 - t) + std::log(hi) * t);
  }
  if (kind == ScaleKind::symlog) {
    const double c = threshold_of(*this);
    return symlog_inverse(symlog(lo, c) * (1 - t) + symlog(hi, c) * t, c);
  }
  return lo * (1 - t) + hi * t;
}

Vec4f ColorScale::color_at(double t) const {
  if (t != t) return opaque(nan);
  if (t < 0 || t > 1) {
    if (!clamp) return {0, 0, 0, 0};
    if (t < 0) return opaque(below ? *below : map.at(0));
    return opaque(above ? *above : map.at(1));
  }
  if (labels.empty()) return opaque(map.at(t));
  const size_t n = labels.size(), i = std::min(n - 1, size_t(t * double(n)));
  if (map.categorical() && !map.colors.empty()) return opaque(map.colors[i % map.colors.size()]);
  return opaque(map.at(n > 1 ? double(i) / double(n - 1) : 0.5));
}

Vec4f ColorScale::color(double value) const { return color_at(position(value)); }

ColorTable color_table(const ColorScale& scale, int size) {
  if (scale.kind == ScaleKind::log && scale.labels.empty() && !(scale.lo > 0 && scale.hi > 0))
    fail_usage(fmt::format("a log colour scale cannot show the range from {} to {}", short_number(scale.lo), short_number(scale.hi)),
               "colour scale", "give a range above 0, or use a symlog scale");
  const size_t n = std::max({size_t(std::max(size, 2)), 2 * scale.labels.size() + 1});
  ColorTable table;
  table.linear.resize(n);
  for (size_t i = 0; i < n; ++i) table.linear[i] = srgb_to_linear(scale.color_at(double(i) / double(n - 1)));
  table.below = srgb_to_linear(scale.color_at(-1));
  table.above = srgb_to_linear(scale.color_at(2));
  table.nan = srgb_to_linear(scale.color_at(no_value));
  return table;
}

std::vector<double> color_knots(const ColorScale& scale) {
  if (!scale.labels.empty()) return {};
  constexpr size_t most = 4096;
  constexpr double narrow = 1.0 / 64;  // of the map: wider ramps are smooth enough for samples
  constexpr int pieces = 16;           // of a narrow one: then sRGB is as good as linear light on each
  const std::vector<Vec3f>& c = scale.map.colors;
  const size_t n = c.size();
  std::vector<double> places{0, 1};  // on the map
  const auto change = [&](size_t i) {
    const Vec4f a = srgb_to_linear(opaque(c[i])), b = srgb_to_linear(opaque(c[i + 1]));
    return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
  };
  if (scale.map.categorical()) {
    for (size_t i = 1; i < n && n <= most; ++i) places.push_back(double(i) / double(n));
  } else {
    const bool even = scale.map.positions.size() != n;
    const auto at = [&](size_t i) { return even ? double(i) / double(n - 1) : scale.map.positions[i]; };
    for (size_t i = 0; i + 1 < n && places.size() < most; ++i) {
      const double width = at(i + 1) - at(i);
      const bool sharp = width < narrow && change(i) > (even ? 0.05f : 0.02f);
      if (!even && n <= 256) places.push_back(at(i));
      if (!sharp) continue;
      for (int k = 0; k <= pieces; ++k) places.push_back(k == pieces ? at(i + 1) : at(i) + width * k / pieces);
    }
  }
  std::vector<double> values;
  for (double t : places) values.push_back(scale.value_at(t));
  if (scale.kind == ScaleKind::log) values.push_back(0);
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

double OpacityCurve::at(double v) const {
  if (points.empty() || v != v) return 0;
  const auto after = std::upper_bound(points.begin(), points.end(), v, [](double x, const Vec2& p) { return x < p.x; });
  if (after == points.begin()) return points.front().y;
  if (after == points.end()) return points.back().y;
  const Vec2 a = after[-1], b = *after;
  return a.y + (b.y - a.y) * ((v - a.x) / (b.x - a.x));
}

double OpacityCurve::most(double a, double b) const {
  if (b < a) std::swap(a, b);
  double most = std::max(at(a), at(b));
  const auto first = std::lower_bound(points.begin(), points.end(), a, [](const Vec2& p, double x) { return p.x < x; });
  for (auto p = first; p != points.end() && p->x <= b; ++p) most = std::max(most, p->y);
  return most;
}

}  // namespace sg
