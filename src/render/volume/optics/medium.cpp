// SPDX-License-Identifier: Apache-2.0
#include "render/volume/optics/medium.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "color/cie.h"
#include "render/volume/optics/transfer.h"

namespace sg::volume {

namespace {

struct Sample {
  double value;
  double tau, r, g, b;
};

/// The curves themselves, from one side of a step.
class Curves {
 public:
  Curves(const ColorScale& scale, const OpacityCurve& curve, const Medium::Plan& plan) : scale_(scale), curve_(curve), plan_(plan) {}
  Sample at(double v) const {
    const Vec4f c = scale_.color(v);
    const double opacity = std::clamp(curve_.at(v), 0.0, 1.0) * double(c.w);
    const double tau = opacity < 1 ? std::min(minus_log_one_minus(opacity) / plan_.unit, plan_.most_tau) : plan_.most_tau;
    return {v, tau, srgb_to_linear(double(c.x)), srgb_to_linear(double(c.y)), srgb_to_linear(double(c.z))};
  }
  Sample beside(double v, double towards) const {
    Sample s = at(std::nextafter(v, towards));
    s.value = v;
    return s;
  }
  bool straight(const Sample& a, const Sample& b, const Sample& m) const {
    const double f = (m.value - a.value) / (b.value - a.value);
    const auto off = [f](double x, double y, double z) { return std::abs(x + f * (y - x) - z); };
    if (off(a.tau, b.tau, m.tau) > plan_.accuracy * std::max(m.tau, plan_.faint)) return false;
    if (m.tau == 0 && a.tau == 0 && b.tau == 0) return true;  // nobody sees the colour
    return std::max({off(a.r, b.r, m.r), off(a.g, b.g, m.g), off(a.b, b.b, m.b)}) <= plan_.accuracy;
  }

 private:
  const ColorScale& scale_;
  const OpacityCurve& curve_;
  const Medium::Plan& plan_;
};

/// Values at which a curve may bend or jump, within [lo, hi].
std::vector<double> bends(const ColorScale& scale, const OpacityCurve& curve, double lo, double hi) {
  std::vector<double> v{lo, hi, scale.lo, scale.hi};
  for (const Vec2& p : curve.points) v.push_back(p.x);
  if (scale.kind != ScaleKind::linear) v.push_back(0);
  if (const size_t n = scale.map.colors.size(); n <= 64 && scale.labels.empty())
    for (size_t i = 1; i + 1 < n; ++i) v.push_back(scale.value_at(double(i) / double(n - 1)));
  for (double l : scale.labels)  // a label is a value with a little air around it
    for (double side : {-1e-3, 1e-3}) v.push_back(l + side);
  std::erase_if(v, [&](double x) { return !(x >= lo && x <= hi); });
  std::sort(v.begin(), v.end());
  v.erase(std::unique(v.begin(), v.end()), v.end());
  return v;
}

/// Appends samples after a, up to and with b, so that straight lines do.
void refine(const Curves& curves, const Sample& a, const Sample& b, int depth, std::vector<Sample>& out) {
  const double middle = 0.5 * (a.value + b.value);
  if (depth > 0 && middle > a.value && middle < b.value && out.size() < 4096) {
    const Sample m = curves.at(middle);
    bool straight = curves.straight(a, b, m);
    for (double f : {0.25, 0.75, 0.1, 0.9})
      if (straight) straight = curves.straight(a, b, curves.at(a.value + f * (b.value - a.value)));
    if (!straight) {
      refine(curves, a, m, depth - 1, out);
      return refine(curves, m, b, depth - 1, out);
    }
  }
  out.push_back(b);
}

Optics optics(const Sample& s) { return {float(s.tau), float(s.r), float(s.g), float(s.b)}; }

Medium::Line line_between(const Sample& a, const Sample& b, float base) {
  Medium::Line l{float(a.value - double(base)), float(b.value - double(base)), 0, optics(a), {}};
  l.origin = l.lo;
  const double d = double(l.hi) - double(l.lo);
  if (d > 0) l.slope = {float((b.tau - a.tau) / d), float((b.r - a.r) / d), float((b.g - a.g) / d), float((b.b - a.b) / d)};
  return l;
}

}  // namespace

Medium::Medium(const ColorScale& scale, const OpacityCurve& curve, const Plan& plan) {
  const Curves curves(scale, curve, plan);
  const double lo = std::min(plan.lo, plan.hi), hi = plan.hi;
  const std::vector<double> at = bends(scale, curve, lo, hi);
  for (size_t i = 0; i + 1 < at.size(); ++i) {
    // Labels: the little interval around one has the look of its middle.
    const bool label = std::any_of(scale.labels.begin(), scale.labels.end(), [&](double l) { return at[i] < l && l < at[i + 1]; });
    const double middle = 0.5 * (at[i] + at[i + 1]);
    Sample a = label ? curves.at(double(float(middle))) : curves.beside(at[i], HUGE_VAL);
    Sample b = label ? a : curves.beside(at[i + 1], -HUGE_VAL);
    a.value = at[i], b.value = at[i + 1];
    std::vector<Sample> samples{a};
    if (scale.labels.empty()) refine(curves, a, b, 12, samples);
    else samples.push_back(b);
    for (size_t k = 0; k + 1 < samples.size(); ++k) {
      const Line l = line_between(samples[k], samples[k + 1], plan.base);
      if (l.hi > l.lo) lines_.push_back(l);
    }
  }
  if (lines_.empty()) lines_.push_back({0, 0, 0, optics(curves.at(lo)), {}});
  bounds();
  // Beyond the data nothing is asked, but for rounding errors.
  lines_.front().lo = -HUGE_VALF, lines_.back().hi = HUGE_VALF;
  slice();
}

void Medium::slice() {
  const size_t n = lines_.size();
  slice_lo_ = n > 1 ? lines_.front().hi : 0;
  const float top = n > 1 ? lines_.back().lo : 0;
  per_slice_ = top > slice_lo_ ? float(slices) / (top - slice_lo_) : 0;
  first_.resize(size_t(slices) + 1);
  size_t line = 0;
  for (int s = 0; s <= slices; ++s) {
    // A line earlier than needed costs a step; one later would be wrong.
    const float v = per_slice_ > 0 ? slice_lo_ + (float(s) - 0.01f) / per_slice_ : slice_lo_;
    while (s > 0 && line + 1 < n && lines_[line].hi <= v) ++line;
    first_[size_t(s)] = uint16_t(line);
  }
}

void Medium::bounds() {
  const size_t n = lines_.size();
  std::vector<float> tau(n), slope(n), color(n);
  for (size_t i = 0; i < n; ++i) {
    const Line& l = lines_[i];
    tau[i] = std::max(l.at.tau, l(l.hi).tau);
    slope[i] = std::abs(l.slope.tau);
    color[i] = std::max({std::abs(l.slope.r), std::abs(l.slope.g), std::abs(l.slope.b)});
  }
  const auto build = [n](std::vector<float> first, std::vector<std::vector<float>>& out) {
    out.push_back(std::move(first));
    for (size_t k = 0, width = 2; width <= n; ++k, width *= 2) {
      std::vector<float> next(n - width + 1);
      for (size_t i = 0; i < next.size(); ++i) next[i] = std::max(out[k][i], out[k][i + width / 2]);
      out.push_back(std::move(next));
    }
  };
  build(std::move(tau), tau_), build(std::move(slope), slope_), build(std::move(color), color_slope_);
}

float Medium::most(const std::vector<std::vector<float>>& table, float lo, float hi) const {
  const size_t a = size_t(line_of(lo)), b = std::max(a, size_t(line_of(hi)));
  const size_t k = size_t(std::bit_width(b - a + 1) - 1);
  return std::max(table[k][a], table[k][b + 1 - (size_t(1) << k)]);
}

bool Medium::clear(float lo, float hi) const { return !(lo <= hi) || most(tau_, lo, hi) == 0; }
float Medium::most_tau(float lo, float hi) const { return most(tau_, lo, hi); }
float Medium::most_slope(float lo, float hi) const { return most(slope_, lo, hi); }
float Medium::most_color_slope(float lo, float hi) const { return most(color_slope_, lo, hi); }

}  // namespace sg::volume
