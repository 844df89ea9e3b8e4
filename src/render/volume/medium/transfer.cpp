// SPDX-License-Identifier: Apache-2.0
#include "render/volume/medium/transfer.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace sg::volume {

// exp(-x) = 2^-k exp(-r), |r| <= ln2/2, by Taylor's series to the 13th power (error below 1e-17).
double exp_negative(double x) {
  if (!(x < 700)) return 0;
  constexpr double ln2 = 0.693147180559945309;
  const double k = double(int(x / ln2 + 0.5)), r = -(x - k * ln2);
  double sum = 1;
  for (int i = 13; i > 0; --i) sum = 1 + sum * r / i;
  return std::ldexp(sum, -int(k));
}

// -log(1-x): with 1-x = m 2^e, log m = 2 atanh((m-1)/(m+1)), m in [sqrt(1/2), sqrt 2).
double minus_log_one_minus(double x) {
  constexpr double ln2 = 0.693147180559945309;
  double z;
  int e = 0;
  if (x < 0.25) {
    z = -x / (2 - x);  // no digits lost for small x
  } else {
    double m = std::frexp(1 - x, &e);
    if (m < 0.70710678118654752) m *= 2, --e;
    z = (m - 1) / (m + 1);
  }
  const double z2 = z * z;
  double sum = 0;
  for (int i = 23; i > 0; i -= 2) sum = sum * z2 + 1.0 / i;
  return -(2 * z * sum + e * ln2);
}

float Transfer::value_on_axis(double a) const {
  if (kind_ == ScaleKind::linear) return float(a);
  const auto power = [](double axis, int zero = 0) {
    const double e = std::floor(axis);
    return std::ldexp(1 + (axis - e), int(e) + zero);
  };
  if (kind_ == ScaleKind::log) return float(power(a, log_zero_));
  return float(std::copysign((power(std::abs(a)) - 1) / double(per_threshold_), a));
}

Transfer::Transfer(const ColorScale& scale, const OpacityCurve& curve, double unit, double step, double lo, double hi, double base)
    : kind_(scale.labels.empty() ? scale.kind : ScaleKind::linear) {
  if (kind_ == ScaleKind::log && scale.lo > 0) log_zero_ = std::ilogb(std::clamp(scale.lo, 1e-30, 1e30));
  // The part of the data's range in which colour or opacity can change.
  double first = std::min(scale.lo, scale.hi), last = std::max(scale.lo, scale.hi);
  for (const Vec2& p : curve.points)
    if (kind_ != ScaleKind::log || p.x > 0) first = std::min(first, p.x), last = std::max(last, p.x);
  for (double l : scale.labels) first = std::min(first, l - 0.5), last = std::max(last, l + 0.5);
  if (lo <= hi) first = std::clamp(first, lo, hi), last = std::clamp(last, lo, hi);
  if (kind_ == ScaleKind::log && !(first > 0)) first = last > 0 ? std::min(last, 1e-30) : 1e-30, last = std::max(last, first);
  if (kind_ == ScaleKind::symlog) {
    const double threshold = scale.linear_threshold > 0 ? scale.linear_threshold : 1e-3 * std::max(std::abs(scale.lo), std::abs(scale.hi));
    per_threshold_ = threshold > 0 ? float(1 / threshold) : 1;
  }
  first_ = axis(float(first - base));
  const float last_axis = axis(float(last - base));
  // A domain of one value still tells below from above.
  per_axis_ = last_axis > first_ ? float(count_) / (last_axis - first_) : 1e30f;

  const ColorTable colors = color_table(scale);
  steps_.resize(size_t(count_) + 3), media_.resize(size_t(count_) + 3), drawn_before_.resize(size_t(count_) + 4);
  const double entry = 1 / double(per_axis_);
  // Spikes of opacity narrower than the table.
  std::vector<uint8_t> thin(size_t(count_) + 3);
  for (size_t k = 0; k + 2 < curve.points.size(); ++k) {
    const float from = float(curve.points[k].x - base), to = float(curve.points[k + 2].x - base);
    if (!(curve.points[k + 1].y > 0 && (axis(to) - axis(from)) * per_axis_ < 2)) continue;
    for (int i = std::max(index(from) - 1, 0); i <= std::min(index(to) + 1, count_ + 1); ++i) thin[size_t(i)] = 1;
  }
  const double beyond = std::max(1e-3 * (last - first), 1e-9 * std::max(std::abs(first), std::abs(last)));
  const auto enter = [&](int i) {
    double value = double(value_on_axis(double(first_) + (double(i) - 0.5) * entry)) + base;
    // Beyond the ends opacity and colour are constant: one takes effect at once, the other where its rounding allows.
    double shade_at = value;
    if (i == 0) value = std::nextafter(first, -HUGE_VAL), shade_at = kind_ == ScaleKind::log ? 0.999 * first : first - beyond;
    if (i == count_ + 1) value = std::nextafter(last, HUGE_VAL), shade_at = last + beyond;
    if (i > 0 && i <= count_) {
      value = std::clamp(value, first, last);
      if (!scale.labels.empty()) {  // the nearest label, if this entry is near enough to be meant
        double best = HUGE_VAL;
        for (double l : scale.labels)
          if (std::abs(l - value) < std::abs(best - value)) best = l;
        if (std::abs(best - value) <= std::max(0.5 * entry, 1e-3)) value = best;
      }
      shade_at = value;
    }
    const Vec4f color = i == count_ + 2 ? Vec4f{} : colors.at(scale.position(shade_at));
    const double opacity = i == count_ + 2 ? 0 : std::clamp(curve.at(value), 0.0, 1.0) * double(color.w);
    const double density = opacity < 1 ? minus_log_one_minus(opacity) / unit : 1e30;
    const double pass = exp_negative(density * step), alpha = 1 - pass;
    media_[size_t(i)] = {color.x, color.y, color.z, float(std::min(density, 1e30))};
    steps_[size_t(i)] = {float(color.x * alpha), float(color.y * alpha), float(color.z * alpha), float(pass)};
    drawn_before_[size_t(i) + 1] = density > 0 || thin[size_t(i)];
  };
  parallel_for(size_t(count_) + 3, 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) enter(int(i));
  });
  for (size_t i = 1; i < drawn_before_.size(); ++i) drawn_before_[i] += drawn_before_[i - 1];
  for (int i = 0; i < count_ + 3; ++i) drawn_eights_[size_t(i) / 256 % 16] |= uint32_t(draws(i)) << i / 8 % 32;
}

bool Transfer::spans(float lo, float hi) const {
  const float slack = 1e-3f;  // of an entry
  return lo <= hi && (axis(lo) - first_) * per_axis_ >= -slack && (axis(hi) - first_) * per_axis_ <= float(count_) + slack;
}

bool Transfer::clear(float lo, float hi) const {
  if (!(lo <= hi)) return true;
  // Interpolation may leave [lo, hi] by rounding errors.
  const float slack = 1e-6f * (std::abs(lo) + std::abs(hi));
  if (!std::isfinite(slack)) return drawn_before_.back() == 0;
  const int a = index(lo - slack), b = index(hi + slack);
  return drawn_before_[size_t(b) + 1] == drawn_before_[size_t(a)];
}

}  // namespace sg::volume
