// SPDX-License-Identifier: Apache-2.0
#include "render/volume/medium/medium.h"

#include <algorithm>
#include <cmath>

#include "color/cie.h"
#include "render/volume/medium/transfer.h"

namespace sg::volume {

namespace {

Vec3 linear_color(const ColorScale& scale, double v) {
  Vec4f c = scale.color(v);
  // What is not drawn has the colour beside it: that of a part's end counts for all of the part.
  if (c.w == 0) c = scale.color_at(scale.position(v) < 0 ? 0 : 1);
  return {srgb_to_linear(double(c.x)), srgb_to_linear(double(c.y)), srgb_to_linear(double(c.z))};
}

double difference(Vec3 a, Vec3 b) { return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)}); }

/// Just inside of a part that begins at `end`: so far that the place on the scale, which rounds, is inside, too.
double just_inside(const ColorScale& scale, double end, double other) {
  const double size = std::max({std::abs(end), std::abs(other), std::abs(scale.lo), std::abs(scale.hi)});
  return end + std::copysign(std::min(1e-3 * std::abs(other - end), 1e-13 * size), other - end);
}

/// The curve of tau.
class Curve {
 public:
  struct Sample {
    double value, tau;
  };
  Curve(const ColorScale& scale, const OpacityCurve& curve, const Medium::Plan& plan) : scale_(scale), curve_(curve), plan_(plan) {
    // Sums over all values have 30 bits or fewer: an opaque part of them may count for so much. A thin one is thin on rays, too.
    double opaque = 0;
    const auto add = [&](double from, double to) { opaque += std::max(0.0, std::min(to, plan.hi) - std::max(from, plan.lo)); };
    const std::vector<Vec2>& p = curve.points;
    for (size_t i = 0; i + 1 < p.size(); ++i)
      if (p[i].y >= 1 && p[i + 1].y >= 1) add(p[i].x, p[i + 1].x);
    if (!p.empty() && p.front().y >= 1) add(plan.lo, p.front().x);
    if (!p.empty() && p.back().y >= 1) add(p.back().x, plan.hi);
    most_ = plan.most_tau * (opaque > 0 ? std::clamp(0.3 * (plan.hi - plan.lo) / opaque, 1.0, 1e3) : 1.0);
    most_ = std::max(most_, minus_log_one_minus(1 - 0x1p-53) / plan.unit);
  }
  Sample at(double v) const { return at(v, v); }
  /// The limit at one end of a part: that of a ramp that ends in opacity 1 is the largest of an opacity below 1.
  Sample beside(double v, double end) const {
    const double opaque = minus_log_one_minus(1 - 0x1p-53) / plan_.unit;
    const Sample s{v, at(std::nextafter(v, end), just_inside(scale_, v, end)).tau};
    return {v, s.tau > opaque && at(0.5 * v + 0.5 * end).tau <= opaque ? opaque : s.tau};
  }
  /// The cubic through four places at equal distances.
  struct Arc {
    double lo, hi, at, slope, curve, twist;
    Arc(Sample a, double first, double second, Sample b) : lo(a.value), hi(b.value), at(a.tau) {
      const double w = hi - lo;
      slope = (-11 * a.tau + 18 * first - 9 * second + 2 * b.tau) / (2 * w);
      curve = 9 * (2 * a.tau - 5 * first + 4 * second - b.tau) / (2 * w * w);
      twist = 9 * (-a.tau + 3 * first - 3 * second + b.tau) / (2 * w * w * w);
    }
    double operator()(double v) const {
      const double d = v - lo;
      return at + d * (slope + d * (curve + d * twist));
    }
    double integral() const {
      const double w = hi - lo;
      return w * (at + w * (slope / 2 + w * (curve / 3 + w * twist / 4)));
    }
  };
  /// Appends arcs from a to b.
  void refine(Sample a, Sample b, int depth, std::vector<Arc>& out) const {
    const double middle = 0.5 * (a.value + b.value), third = (b.value - a.value) / 3;
    if (!(middle > a.value && middle < b.value)) return out.push_back(even(a, b));
    const Arc arc(a, at(a.value + third).tau, at(b.value - third).tau, b);
    bool good = true;
    for (double f : {0.5, 0.06, 0.17, 0.83, 0.94}) {
      const Sample s = at(a.value + f * (b.value - a.value));
      good = good && std::abs(arc(s.value) - s.tau) <= plan_.accuracy * std::max(s.tau, plan_.faint);
    }
    if (good) return out.push_back(arc);
    if (depth == 0 || out.size() > 4096) return out.push_back(as_deep(a, b));
    refine(a, at(middle), depth - 1, out);
    refine(at(middle), b, depth - 1, out);
  }
  /// The last arc before opacity 1, where tau = ln(1 / x) / unit has no end but an integral, ln(1 / x) + 1: the end that gives the cubic
  /// through both thirds the same.
  Arc as_deep(Sample a, Sample b) const {
    const double third = (b.value - a.value) / 3, rise = (8 - 3 * std::log(4.5)) / plan_.unit;
    const bool first = at(a.value).tau >= most_, last = at(b.value).tau >= most_;
    if (first && !last) a.tau = b.tau + rise;
    if (last && !first) b.tau = a.tau + rise;
    return {a, at(a.value + third).tau, at(b.value - third).tau, b};
  }
  static Arc even(Sample a, Sample b) { return {a, a.tau + (b.tau - a.tau) / 3, b.tau - (b.tau - a.tau) / 3, b}; }

 private:
  /// Where the scale is asked at `on_scale` whether it draws v.
  Sample at(double v, double on_scale) const {
    const double opacity = std::clamp(curve_.at(v), 0.0, 1.0) * double(scale_.color(on_scale).w);
    return {v, opacity < 1 ? minus_log_one_minus(opacity) / plan_.unit : most_};
  }

  const ColorScale& scale_;
  const OpacityCurve& curve_;
  const Medium::Plan& plan_;
  double most_ = 0;
};

/// Values in [lo, hi] at which tau may bend or jump, or colour may jump.
std::vector<double> bends(const ColorScale& scale, const OpacityCurve& curve, double lo, double hi) {
  std::vector<double> v{lo, hi};
  for (const Vec2& p : curve.points) v.push_back(p.x);
  const std::vector<double> colors = color_knots(scale);
  v.insert(v.end(), colors.begin(), colors.end());
  for (double l : scale.labels)  // a label is a value with a little air around it
    for (double side : {-1e-3, 1e-3}) v.push_back(l + side);
  std::erase_if(v, [&](double x) { return !(x >= lo && x <= hi); });
  std::sort(v.begin(), v.end());
  v.erase(std::unique(v.begin(), v.end()), v.end());
  return v;
}

}  // namespace

Medium::Medium(const ColorScale& scale, const OpacityCurve& curve, const Plan& plan)
    : kind_(scale.labels.empty() ? scale.kind : ScaleKind::linear), base_(plan.base) {
  if (kind_ == ScaleKind::log && scale.lo > 0) log_zero_ = std::ilogb(std::clamp(scale.lo, 1e-30, 1e30));
  const Spans spans = make_lines(scale, curve, plan);
  make_colors(scale, plan);
  find_abrupt(scale, spans);
}

Medium::Spans Medium::make_lines(const ColorScale& scale, const OpacityCurve& curve, const Plan& plan) {
  const Curve tau(scale, curve, plan);
  const double lo = std::min(plan.lo, plan.hi), hi = plan.hi, base = double(plan.base);
  const std::vector<double> at = bends(scale, curve, lo, hi);
  Spans spans;
  for (size_t i = 0; i + 1 < at.size(); ++i) {
    Curve::Sample a = tau.beside(at[i], at[i + 1]), b = tau.beside(at[i + 1], at[i]);
    // The little interval around a label has the look of its middle.
    for (double l : scale.labels)
      if (at[i] < l && l < at[i + 1]) a.tau = b.tau = tau.at(l).tau;
    std::vector<Curve::Arc> arcs;
    if (scale.labels.empty()) tau.refine(a, b, 12, arcs);
    else arcs.push_back(Curve::even(a, b));
    double left_over = 0;  // the integral of arcs that are nothing in floats
    for (const Curve::Arc& arc : arcs) {
      const float from = float(arc.lo - base), to = float(arc.hi - base), far = std::max(std::abs(from), std::abs(to));
      if (!(to > from)) {
        left_over += arc.integral();
        continue;
      }
      Line l{from, to, from, float(arc.at), float(arc.slope), float(arc.curve), float(arc.twist)};
      // Ends that are rounded lie beside a steep arc of a few floats: as beside opacity 1, where tau has no end. Its mean holds.
      if (arcs.size() > 1 && to - from < 8 * (std::nextafter(far, HUGE_VALF) - far)) {
        l.at = float((arc.integral() + left_over) / (double(to) - double(from))), l.slope = l.curve = l.twist = 0;
        left_over = 0;
      }
      // What is narrower than floats can tell is straight.
      if (!(std::isfinite(l.slope) && std::isfinite(l.curve) && std::isfinite(l.twist)))
        l.slope = float((arc(arc.hi) - arc.at) / (double(to) - double(from))), l.curve = l.twist = 0;
      if (!std::isfinite(l.slope)) l.slope = 0;
      lines_.push_back(l), spans.push_back({arc.lo, arc.hi});
    }
  }
  if (lines_.empty()) lines_.push_back({0, 0, 0, float(tau.at(lo).tau), 0, 0, 0}), spans.push_back({lo, hi});
  bound();
  top_ = lines_.back().hi, accuracy_ = float(plan.accuracy), faint_ = float(plan.faint);
  unit_ = float(plan.unit), per_unit_ = float(1 / plan.unit);
  // Beyond the data nothing is asked, but for rounding errors.
  lines_.front().lo = -HUGE_VALF, lines_.back().hi = HUGE_VALF;
  for (const Line& l : lines_) columns_.hi.push_back(l.hi);
  slice();
  return spans;
}

double Medium::value_on_axis(double a) const {
  if (kind_ == ScaleKind::linear) return a + double(base_);
  const auto power = [](double axis, int zero = 0) {
    const double e = std::floor(axis);
    return std::ldexp(1 + (axis - e), int(e) + zero);
  };
  if (kind_ == ScaleKind::log) return power(a, log_zero_);
  return std::copysign((power(std::abs(a)) - 1) / double(per_threshold_), a);
}

void Medium::make_colors(const ColorScale& scale, const Plan& plan) {
  // Where the colours change: the range of the scale, as far as there are data; and a bit beyond, for what lies below and above.
  const double ends[2] = {std::min(scale.lo, scale.hi), std::max(scale.lo, scale.hi)}, air = (ends[1] - ends[0]) / 1000;
  double lo = std::max(std::min(plan.lo, plan.hi), ends[0] - air), hi = std::min(plan.hi, ends[1] + air);
  if (!scale.labels.empty()) lo = plan.lo, hi = plan.hi;
  if (!(lo <= hi)) lo = hi = plan.hi < ends[0] ? plan.hi : plan.lo;  // all data on one side of the scale
  if (kind_ == ScaleKind::log && !(lo > 0)) lo = hi > 0 ? std::min(hi, ends[0] > 0 ? ends[0] : 1e-30) : 1e-30, hi = std::max(lo, hi);
  if (kind_ == ScaleKind::symlog) {
    const double threshold = scale.linear_threshold > 0 ? scale.linear_threshold : 1e-3 * std::max(std::abs(scale.lo), std::abs(scale.hi));
    per_threshold_ = threshold > 0 ? float(1 / threshold) : 1;
  }
  first_node_ = axis(float(lo - double(base_)));
  const float last = axis(float(hi - double(base_)));
  per_node_ = last > first_node_ ? float(nodes) / (last - first_node_) : 0;
  const double per = per_node_ > 0 ? 1 / double(per_node_) : 0;
  std::vector<Vec3> c(size_t(nodes) + 1);
  colors_.resize(4 * c.size());
  for (int i = 0; i <= nodes; ++i) {
    double value = std::clamp(value_on_axis(double(first_node_) + i * per), lo, hi);
    double best = HUGE_VAL;
    for (double l : scale.labels)
      if (std::abs(l - value) < std::abs(best - value)) best = l;
    if (std::abs(best - value) <= std::max(0.5 * per, 1e-3)) value = best;
    c[size_t(i)] = linear_color(scale, value);
    for (size_t k = 0; k < 3; ++k) colors_[4 * size_t(i) + k] = uint16_t(std::clamp(c[size_t(i)][int(k)], 0.0, 1.0) * 65535 + 0.5);
  }
  abrupt_colors_ = false;
  for (size_t i = 0; i < size_t(nodes) && scale.labels.empty(); ++i)
    abrupt_colors_ = abrupt_colors_ || difference(c[i], c[i + 1]) > 1.0 / 64;
  // The widest change over which a straight line does, between jumps (which are knots).
  double steepest = 0;
  std::vector<double> knots;  // on the axis
  for (double k : color_knots(scale)) knots.push_back(double(axis(float(k - double(base_)))));
  std::vector<size_t> stretches = {0};  // of the stretches without a jump: first and last node
  for (size_t i = 0; i < size_t(nodes); ++i) {
    const double change = difference(c[i], c[i + 1]);
    const double here = first_node_ + double(i) * per;
    const bool knot = change > 1e-5 && std::any_of(knots.begin(), knots.end(), [&](double k) { return k >= here && k <= here + per; });
    if (change > 0.02 || knot) stretches.push_back(i), stretches.push_back(i + 1);
    else steepest = std::max(steepest, change);
  }
  stretches.push_back(size_t(nodes));
  if (scale.labels.empty()) {
    // A value has the colour of the nearest node; the nodes of lines are as many as it takes.
    abrupt_colors_ = abrupt_colors_ || steepest > 4 * plan.accuracy;
    for (double k : color_knots(scale)) {
      if (!(k > lo && k < hi)) continue;
      const Vec3 before = linear_color(scale, just_inside(scale, k, lo)), after = linear_color(scale, just_inside(scale, k, hi));
      abrupt_colors_ = abrupt_colors_ || difference(before, after) > plan.accuracy;
    }
  }
  const auto straight = [&](size_t from, size_t to) {
    for (size_t q = 1; q < 8; ++q) {
      const size_t at = from + (to - from) * q / 8;
      const double f = double(at - from) / double(to - from);
      if (difference(c[from] + (c[to] - c[from]) * f, c[at]) > 2 * plan.accuracy) return false;
    }
    return true;
  };
  size_t width = size_t(nodes);
  for (; width > 8; width /= 2) {
    bool all = true;
    for (size_t e = 0; e < stretches.size() && all; e += 2)
      for (size_t i = stretches[e]; i < stretches[e + 1] && all; i += width / 2) all = straight(i, std::min(i + width, stretches[e + 1]));
    if (all) break;
  }
  color_width_ = per > 0 ? float(double(width) * per) : 1e30f, color_slope_ = float(steepest * double(per_node_));
}

/// Nodes for each line: colours are those of the line up to its very ends, and change by no more than the accuracy from node to node.
void Medium::piece_colors(const ColorScale& scale, const Spans& spans) {
  colors_.clear();
  const double all = std::abs(double(axis(top_)) - double(axis(lines_.front().origin)));
  const double finest = std::max(double(accuracy_), 2.0 / 65535);  // 16 bits tell no nearer ones apart
  const int most = int(std::clamp((size_t(1) << 22) / lines_.size(), size_t(8), size_t(1) << 16));
  std::vector<Vec3> c;
  for (size_t i = 0; i < lines_.size(); ++i) {
    const double from = just_inside(scale, spans[i].x, spans[i].y), to = just_inside(scale, spans[i].y, spans[i].x);
    const Vec3 a = linear_color(scale, from), m = linear_color(scale, 0.5 * from + 0.5 * to), b = linear_color(scale, to);
    const float lo = axis(lines_[i].origin), hi = axis(std::min(lines_[i].hi, top_));
    const double share = all > 0 ? std::clamp((double(hi) - double(lo)) / all, 0.0, 1.0) : 0, change = difference(a, m) + difference(m, b);
    const bool even = change == 0 && difference(linear_color(scale, 0.75 * from + 0.25 * to), m) == 0;
    int count = even || !(hi > lo) ? 0 : int(std::ceil(std::max({8.0, 2 * share * nodes, std::min(change, 1.0) * 1024})));
    for (bool finer = true; finer;) {
      c.clear();
      double step = 0;
      for (int k = 0; k <= count; ++k) {
        const double at = double(lo) + (double(hi) - double(lo)) * k / std::max(count, 1);
        c.push_back(linear_color(scale, std::clamp(count > 0 ? value_on_axis(at) : 0.5 * from + 0.5 * to, from, std::max(from, to))));
        if (k > 0) step = std::max(step, difference(c[size_t(k) - 1], c[size_t(k)]));
      }
      finer = step > finest && count < most;
      if (finer) count = int(std::min(double(most), std::ceil(1.05 * count * step / finest)));
    }
    pieces_.push_back({lo, count > 0 ? float(count) / (hi - lo) : 0, float(colors_.size() / 4), float(count)});
    for (const Vec3& color : c) {
      for (int q = 0; q < 3; ++q) colors_.push_back(uint16_t(std::clamp(color[q], 0.0, 1.0) * 65535 + 0.5));
      colors_.push_back(0);
    }
  }
  for (int k = 0; k < 4; ++k) colors_.push_back(0);  // vectors load two at once
}

void Medium::find_abrupt(const ColorScale& scale, const Spans& spans) {
  if (abrupt_colors_) piece_colors(scale, spans);
  const size_t n = lines_.size();
  recolors_.assign(n, 0), abrupt_before_.assign(n, 0);
  const float part = (top_ - lines_.front().origin) * (1.0f / 256), unseen = accuracy_ * faint_;
  std::vector<uint8_t> steep(n), recolored(n);  // within so small a part of the values
  for (size_t i = 0; i < n; ++i) {
    const float most = std::max({columns_.most_tau[i], i > 0 ? columns_.most_tau[i - 1] : 0, i + 1 < n ? columns_.most_tau[i + 1] : 0});
    const bool narrow = std::min(lines_[i].hi, top_) - lines_[i].origin < part;
    steep[i] = narrow && most > unseen && columns_.most_slope[i] * part > most;
    recolored[i] = narrow && pieced() && difference(Vec3(color(lines_[i].origin, int(i))), Vec3(color(lines_[i].hi, int(i)))) > 0.004;
  }
  for (size_t i = 1; i < n; ++i) {
    const float before = lines_[i - 1](lines_[i - 1].hi), after = lines_[i](lines_[i].origin), most = std::max(before, after);
    const bool jump = std::abs(after - before) > std::max(unseen, std::max(accuracy_, 1e-5f) * most);
    const bool recolor = pieced() && difference(Vec3(color(lines_[i].origin, int(i - 1))), Vec3(color(lines_[i].origin, int(i)))) > 0.002;
    recolors_[i] = recolor || recolored[i] || recolored[i - 1];
    abrupt_before_[i] = abrupt_before_[i - 1] + (jump || steep[i] || steep[i - 1] || recolors_[i]);
  }
}

void Medium::bound() {
  const size_t n = lines_.size();
  for (const Line& l : lines_) {
    columns_.origin.push_back(l.origin), columns_.at.push_back(l.at), columns_.slope.push_back(l.slope);
    columns_.curve.push_back(l.curve), columns_.twist.push_back(l.twist);
    float most = 0, steepest = 0;
    for (int i = 0; i <= 8; ++i) {
      const float d = (l.hi - l.lo) * (float(i) / 8);
      most = std::max(most, l(l.lo + d)), steepest = std::max(steepest, std::abs(l.slope + d * (2 * l.curve + d * 3 * l.twist)));
    }
    columns_.most_tau.push_back(most), columns_.most_slope.push_back(steepest);
  }
  for (std::vector<float>* table : {&columns_.most_tau, &columns_.most_slope})
    for (size_t width = 2, row = n; width <= n; width *= 2, row += n) {
      table->resize(row + n);
      for (size_t i = 0; i + width <= n; ++i) (*table)[row + i] = std::max((*table)[row - n + i], (*table)[row - n + i + width / 2]);
    }
}

std::vector<Medium::Straight> Medium::straight() const {
  std::vector<Straight> out;
  for (size_t number = 0; number < lines_.size(); ++number) {
    const Line& l = lines_[number];
    const float lo = l.origin, hi = std::min(l.hi, top_), width = hi - lo;
    // A parabola leaves its chord by curve width^2 / 4; a cubic's curve is steepest at an end.
    const float tau = std::max({l.at, l(hi), faint_}),
                bend = 0.25f * std::max(std::abs(l.curve), std::abs(l.curve + 3 * l.twist * width)) * width * width;
    const float parts = std::max(std::sqrt(bend / (2 * accuracy_ * tau)), std::abs(axis(hi) - axis(lo)) / color_width_);
    const int n = l.dark() ? 1 : std::max(int(std::ceil(std::min(1024.0f, parts))), 1);
    for (int i = 0; i < n; ++i) {
      const float a = lo + width * (float(i) / float(n)), b = i + 1 == n ? hi : lo + width * (float(i + 1) / float(n));
      const float w = b - a;
      if (!(w > 0) && !(n == 1 && lines_.size() == 1)) continue;
      // Colours from just inside: at a knot they may jump.
      const Vec3f ca = color(a + 1e-3f * w, int(number)), cb = color(b - 1e-3f * w, int(number));
      const float ta = l(a), tb = l(b), per = w > 0 ? 1 / w : 0;
      out.push_back({a, b, {ta, ca}, {(tb - ta) * per, (cb - ca) * per}});
    }
  }
  return out;
}

void Medium::slice() {
  const size_t n = lines_.size();
  slice_lo_ = n > 1 ? lines_.front().hi : 0;
  const float top = n > 1 ? lines_.back().lo : 0;
  per_slice_ = top > slice_lo_ ? float(slices) / (top - slice_lo_) : 0;
  first_.resize(size_t(slices) + 2);  // one more: vectors load two at once
  size_t line = 0;
  for (int s = 0; s <= slices; ++s) {
    // A line earlier than needed costs a step; one later would be wrong.
    const float v = per_slice_ > 0 ? slice_lo_ + (float(s) - 0.01f) / per_slice_ : slice_lo_;
    while (s > 0 && line + 1 < n && lines_[line].hi <= v) ++line;
    first_[size_t(s)] = uint16_t(line);
  }
}

float Medium::most(const std::vector<float>& table, float lo, float hi) const {
  const size_t n = lines_.size(), a = size_t(line_of(lo)), b = std::max(a, size_t(line_of(hi)));
  const size_t k = size_t(std::bit_width(b - a + 1) - 1);
  return std::max(table[k * n + a], table[k * n + b + 1 - (size_t(1) << k)]);
}

}  // namespace sg::volume
