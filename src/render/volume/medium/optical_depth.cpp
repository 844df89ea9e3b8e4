// SPDX-License-Identifier: Apache-2.0
#include "render/volume/medium/optical_depth.h"

#include <algorithm>
#include <cmath>

#include "color/widgets/transfer_widget.h"
#include "render/volume/medium/cubic.h"
#include "render/volume/medium/detail.h"

namespace sg::volume {

namespace {

/// Where the antiderivative of a line is counted from: its lower end where it has one.
double reference(const Medium::Line& l) {
  return std::isfinite(l.lo) ? double(l.lo) : std::isfinite(l.hi) ? double(l.hi) : double(l.origin);
}
double primitive(const Medium::Line& l, double v) {
  const double d = v - double(l.origin);
  return d * (double(l.at) + d * (0.5 * double(l.slope) + d * (double(l.curve) / 3 + d * 0.25 * double(l.twist))));
}

}  // namespace

DepthIntegral::DepthIntegral(Extinction extinction) : medium_(extinction.medium), detail_(extinction.detail) {
  double sum = 0;
  for (const Medium::Line& l : medium_.lines()) {
    before_.push_back(sum);
    if (std::isfinite(l.lo) && std::isfinite(l.hi)) sum += primitive(l, double(l.hi)) - primitive(l, double(l.lo));
  }
}

double DepthIntegral::antiderivative(float v) const {
  const auto i = size_t(medium_.line_of(v));
  const Medium::Line& l = medium_.lines()[i];
  return before_[i] + primitive(l, double(v)) - primitive(l, reference(l));
}

double DepthIntegral::mean(float a, float b) const {
  const int line = medium_.line_of(a);
  if (line == medium_.line_of(b)) {
    const Medium::Line& l = medium_.lines()[size_t(line)];
    return (double(l(a)) + 4 * double(l(0.5f * (a + b))) + double(l(b))) * (1.0 / 6);
  }
  return std::max(0.0, (antiderivative(b) - antiderivative(a)) / (double(b) - double(a)));
}

// How many straight parts do for a stretch whose values are lo to hi.
int DepthIntegral::chords(const Stretch& s, float lo, float hi) const {
  // The cubic leaves a chord of 1/n of it by at most 3/4 of its largest second difference / n^2.
  const float bend = std::max(std::abs(s.b[0] - 2 * s.b[1] + s.b[2]), std::abs(s.b[1] - 2 * s.b[2] + s.b[3]));
  const double error = (s.to - s.from) * double(medium_.most_slope(lo, hi)) * 0.75 * double(bend);
  return std::clamp(int(std::ceil(std::sqrt(std::min(1.0, error) * 1e4))), 1, 16);
}

bool DepthIntegral::straight(const Stretch& s) const {
  const float lo = s.lowest(), hi = s.highest();
  return !detail_ && lo <= hi && !(medium_.any_abrupt() && medium_.abrupt(lo, hi)) && chords(s, lo, hi) == 1;
}

double DepthIntegral::over(const Stretch& s) const {
  const float lo = s.lowest(), hi = s.highest();
  if (!(lo <= hi) || medium_.clear(lo, hi)) return 0;
  const double length = s.to - s.from;
  const int n = chords(s, lo, hi);
  // A value that turns beyond a jump of the medium may spend any share of its way there: parts end where it turns, and are cut at knots.
  double turn[3] = {2, 2, 2};
  const bool abrupt = medium_.any_abrupt() && medium_.abrupt(lo, hi);
  if (abrupt) turn[turns(s.b, turn)] = 2;
  double sum = 0, f = 0;
  float v = s.b[0];
  const double* next_turn = turn;
  for (int k = 1; k <= n;) {
    double to = double(k) / n;
    if (*next_turn < to) to = *next_turn++;
    else ++k;
    const float next = to == 1 ? s.b[3] : s.value(s.from + length * to);
    sum += abrupt ? between_knots(s, f, to, v, next) : (to - f) * mean(v, next);
    v = next, f = to;
  }
  return sum * length;
}

double DepthIntegral::between_knots(const Stretch& s, double from, double to, float a, float b) const {
  const std::vector<Medium::Line>& lines = medium_.lines();
  if (a != a || b != b) return 0;
  const bool up = b >= a;
  double sum = 0;
  const auto part = [&](const Medium::Line& l, double f0, double f1, float v0, float v1) {
    const float middle = float(bernstein(s.b, 0.5 * (f0 + f1)));
    sum += (f1 - f0) * (double(l(v0)) + 4 * double(l(middle)) + double(l(v1))) * (1.0 / 6);
  };
  for (int i = medium_.line_of(a);; i += up ? 1 : -1) {
    const Medium::Line& l = lines[size_t(i)];
    if (up ? b <= l.hi : b >= l.lo) {
      part(l, from, to, a, b);
      return sum;
    }
    const float knot = up ? l.hi : l.lo;
    double meets[3], at = up == (bernstein(s.b, 0.5 * (from + to)) > double(knot)) ? from : to;
    for (int k = crossings(s.b, knot, meets) - 1; k >= 0; --k)
      if (meets[k] >= from && meets[k] <= to) at = meets[k];
    part(l, from, at, a, knot);
    from = at, a = knot;
  }
}

double DepthIntegral::over(const Stretch& s, RayField& walker) const { return detail_ ? optical_depth(*detail_, s, walker) : over(s); }

void DepthRay::clip(const std::vector<ClipPlane>& planes) {
  for (const ClipPlane& p : planes) {
    const double d = dot(p.normal, direction), rest = p.offset - dot(p.normal, origin);
    if (d > 0) to = std::min(to, rest / d);
    else if (d < 0) from = std::max(from, rest / d);
    else if (rest < 0) to = from - 1;
  }
}

void depths_along(const DepthRay& ray, RayField& walker, const DepthIntegral& integral, double spacing, float most,
                  std::span<float> depth) {
  double sum = 0;
  size_t i = 0;
  if (ray.from < ray.to) {
    walker.start(ray.origin, ray.direction, ray.from, ray.to);
    Stretch ahead[32];
    for (size_t count; i < depth.size() && sum < double(most) && (count = walker.next(ahead)) > 0;)
      for (size_t k = 0; k < count; ++k) {
        Stretch s = ahead[k];
        for (; i < depth.size() && double(i) * spacing <= s.from; ++i) depth[i] = float(sum);
        if (integral.straight(s)) {
          double from = s.from;
          float value = s.b[0];
          const auto go = [&](double t, float next) { sum += (t - from) * integral.mean(value, next), from = t, value = next; };
          for (; i < depth.size() && double(i) * spacing < s.to; ++i)
            go(double(i) * spacing, s.value(double(i) * spacing)), depth[i] = float(sum);
          if (i >= depth.size()) return;
          go(s.to, s.b[3]);
          continue;
        }
        for (; i < depth.size() && double(i) * spacing < s.to; ++i) {
          const double t = double(i) * spacing;
          sum += integral.over(part_of(s, s.from, t), walker);
          depth[i] = float(sum);
          s = part_of(s, t, s.to);
        }
        if (i >= depth.size()) return;
        sum += integral.over(s, walker);
      }
  }
  const float rest = sum < double(most) ? float(sum) : HUGE_VALF;
  for (; i < depth.size(); ++i) depth[i] = rest;
}

void append_numbers(std::string& key, std::initializer_list<double> numbers) {
  for (double n : numbers) key.append(reinterpret_cast<const char*>(&n), sizeof n);
}

std::string extinction_key(const VolumeItem& item, const Extinction& extinction) {
  std::string key = item.field + '|' + std::string(word_of(item.sampling.kernel)) + '|';
  append_numbers(key, {double(int(item.association)), double(item.component), double(item.color.labels.empty())});
  for (const ClipPlane& p : item.clip) append_numbers(key, {p.normal.x, p.normal.y, p.normal.z, p.offset});
  key += '|';
  for (const Medium::Line& l : extinction.medium.lines())
    for (float f : {l.lo, l.hi, l.origin, l.at, l.slope, l.curve, l.twist}) key.append(reinterpret_cast<const char*>(&f), sizeof f);
  if (!extinction.detail) return key;
  const TransferDetail& d = item.detail;
  key += d.second_field + '|' + std::string(word_of(item.sampling.gradient)) + '|';
  append_numbers(key, {double(int(d.second)), extinction.detail->unit});
  for (const auto& p : d.second_factor.points) append_numbers(key, {p.x, p.y});
  for (const TransferWidget& w : d.widgets) {
    append_numbers(key, {double(int(w.shape)), w.lo, w.hi, w.second_lo, w.second_hi, w.opacity});
    append_numbers(key, {double(w.line.size()), w.radius, w.second_radius});
    for (const Vec2& p : w.line) append_numbers(key, {p.x, p.y});
  }
  return key;
}

}  // namespace sg::volume
