// SPDX-License-Identifier: Apache-2.0
#include "render/volume/optics/integrate.h"

#include <bit>
#include <cmath>

namespace sg::volume {

// exp(-x) = 2^-k exp(-r), |r| <= ln2/2, Taylor to the 7th power.
float exp_minus(float x) {
  if (!(x < 87)) return 0;
  constexpr float ln2_hi = 0.693145752f, ln2_lo = 1.42860677e-6f, per_ln2 = 1.44269504f;
  const float k = float(int(x * per_ln2 + 0.5f)), r = -((x - k * ln2_hi) - k * ln2_lo);
  float sum = 1.0f / 5040;
  sum = sum * r + 1.0f / 720, sum = sum * r + 1.0f / 120, sum = sum * r + 1.0f / 24, sum = sum * r + 1.0f / 6;
  sum = sum * r + 0.5f, sum = sum * r + 1, sum = sum * r + 1;
  return sum * std::bit_cast<float>((127 - int(k)) << 23);
}

Stretch part_of(const Stretch& s, double from, double to) {
  const double length = s.to - s.from;
  const float a = float((from - s.from) / length), b = float((to - s.from) / length);
  // The blossom of the cubic: b0 = f(a,a,a), b1 = f(a,a,b), b2 = f(a,b,b), b3 = f(b,b,b).
  const auto blossom = [&s](float u, float v, float w) {
    float p[4] = {s.b[0], s.b[1], s.b[2], s.b[3]};
    const float at[3] = {u, v, w};
    for (int level = 0; level < 3; ++level)
      for (int i = 0; i < 3 - level; ++i) p[i] += at[level] * (p[i + 1] - p[i]);
    return p[0];
  };
  return {from, to, {blossom(a, a, a), blossom(a, a, b), blossom(a, b, b), blossom(b, b, b)}, s.cell};
}

namespace {

constexpr int most_cuts = 6;  // halvings of a stretch for its light or its colour

/// Where there is light on the ends of a part of a stretch, linear between them.
struct LitPart {
  double from, to;
  Lit first, last;
  Lit at(double t) const {
    const float f = to > from ? float((t - from) / (to - from)) : 0;
    return {first.diffuse + f * (last.diffuse - first.diffuse), first.specular + f * (last.specular - first.specular)};
  }
};

class Pieces {
 public:
  Pieces(const Look& look, RayState& state) : look_(look), state_(state) {}

  const LitPart* lit = nullptr;

  /// A part of optical depth D whose colour is `mean` by emission and changes by `change` from its front to its back, `weight` of the
  /// way on by emission: C = mean A less what the front hides of the change (exact for constant tau).
  void segment(double t, float length, float depth, const Optics& mean, const Optics& change, float weight) {
    if (!(depth > 0)) return;
    const float pass = exp_minus(depth), alpha = depth < 0.02f ? depth * (1 - depth * (0.5f - depth * (1.0f / 6))) : 1 - pass;
    // A/2 - A/D + exp(-D), by its series where that cancels.
    const float hidden =
        depth < 0.2f ? depth * depth * (1.0f / 12 - depth * (1.0f / 24 - depth * (1.0f / 80))) : 0.5f * alpha - alpha / depth + pass;
    float r = mean.r * alpha - change.r * hidden, g = mean.g * alpha - change.g * hidden, b = mean.b * alpha - change.b * hidden;
    if (lit) {
      const Lit l = lit->at(t + double(length) * double(weight - hidden / alpha));
      const float flash = l.specular * alpha;
      r = r * l.diffuse + flash, g = g * l.diffuse + flash, b = b * l.diffuse + flash;
    }
    Gathered& sum = state_.sum;
    const float before = sum.transmittance;
    sum.r += before * r, sum.g += before * g, sum.b += before * b;
    sum.transmittance = before * pass;
    if (state_.surface < 0 && sum.transmittance < 0.5f) {
      // tau as good as constant: half of the light is gone at the share ln(2 before)/depth of the way.
      const double gone = before > 0.5f ? std::log(2.0 * double(before)) / double(depth) : 0;
      state_.surface = t + double(length) * std::min(gone, 1.0), state_.surface_id = look_.id;
    }
  }

  /// tau and colour linear over [t, t + length].
  void linear(double t, float length, const Optics& first, const Optics& last) {
    const float t0 = std::max(first.tau, 0.0f), t1 = std::max(last.tau, 0.0f), both = t0 + t1;
    if (!(both > 0)) return;
    const float weight = (t0 + 2 * t1) / (3 * both);
    const Optics change{last.tau - first.tau, last.r - first.r, last.g - first.g, last.b - first.b};
    const Optics mean{0, first.r + change.r * weight, first.g + change.g * weight, first.b + change.b * weight};
    segment(t, length, length * 0.5f * both, mean, change, weight);
  }

  /// A piece on which the value goes straight from a to b: cut at the knots of the medium.
  void straight(double t, float length, float a, float b) {
    const std::vector<Medium::Line>& lines = look_.medium.lines();
    int i = look_.medium.line_of(a);
    if (a == b) {
      const Optics o = lines[size_t(i)](a);
      return linear(t, length, o, o);
    }
    const float per_value = length / std::abs(b - a);
    const bool up = b > a;
    if (!up && i > 0 && lines[size_t(i)].lo == a) --i;
    for (float v = a;;) {
      const Medium::Line& line = lines[size_t(i)];
      const bool last = up ? b <= line.hi : b >= line.lo;
      const float next = last ? b : up ? line.hi : line.lo;
      const float way = std::abs(next - v) * per_value;
      linear(t, way, line(v), line(next));
      if (last) return;
      t += double(way), v = next, i += up ? 1 : -1;
    }
  }

  /// A stretch whose values lie on one line of the medium.
  void smooth(const Stretch& s, const Medium::Line& line) {
    const float length = float(s.to - s.from), mean = 0.25f * (s.b[0] + s.b[1] + s.b[2] + s.b[3]);
    const Optics here = line(mean);
    if (!(here.tau > 0)) return;
    // The mean value by emission: integral of f tau(f) = tau(mean) mean + tau' (integral of f^2 - mean^2), f - mean in Bernstein form.
    const float d0 = s.b[0] - mean, d1 = s.b[1] - mean, d2 = s.b[2] - mean, d3 = s.b[3] - mean;
    const float spread =
        (10 * (d0 * d0 + d3 * d3) + 6 * (d1 * d1 + d2 * d2) + 10 * (d0 * d1 + d2 * d3) + 4 * (d0 * d2 + d1 * d3) + 9 * d1 * d2 + d0 * d3) *
        (1.0f / 70);
    const float off = line.slope.tau * spread / here.tau, span = s.b[3] - s.b[0];
    const Optics by_emission{0, here.r + line.slope.r * off, here.g + line.slope.g * off, here.b + line.slope.b * off};
    const Optics change{0, line.slope.r * span, line.slope.g * span, line.slope.b * span};
    const Optics front = line(s.b[0]), back = line(s.b[3]);
    const float both = std::max(front.tau, 0.0f) + std::max(back.tau, 0.0f);
    segment(s.from, length, length * here.tau, by_emission, change,
            both > 0 ? (std::max(front.tau, 0.0f) + 2 * std::max(back.tau, 0.0f)) / (3 * both) : 0.5f);
  }

  void whole(const Stretch& s, float lo, float hi) {
    const Medium& medium = look_.medium;
    const int first = medium.line_of(lo), last = medium.line_of(hi);
    if (first == last) return smooth(s, medium.lines()[size_t(first)]);
    // The cubic leaves the straight line between its ends by at most this much.
    const float bend = std::max(std::abs(s.b[1] - (2 * s.b[0] + s.b[3]) / 3), std::abs(s.b[2] - (s.b[0] + 2 * s.b[3]) / 3));
    const double length = s.to - s.from;
    const double by_depth = length * double(medium.most_slope(lo, hi));
    const double by_color = std::min(1.0, length * double(medium.most_tau(lo, hi))) * double(medium.most_color_slope(lo, hi));
    const double error = double(bend) * (by_depth + by_color) * double(state_.sum.transmittance);
    const double allowed = 0.25 * look_.budget.tolerance * (length / look_.budget.length + 0.1);
    int n = 1;
    while (n < 64 && error > allowed * n * n) n *= 2;
    const double step = length / n;
    float a = s.b[0];
    for (int k = 0; k < n; ++k) {
      const float b = k + 1 == n ? s.b[3] : s.value(s.from + (k + 1) * step);
      straight(s.from + k * step, float(step), a, b);
      a = b;
    }
  }

 private:
  const Look& look_;
  RayState& state_;
};

/// Cuts the stretch until the light on its ends tells the light on its way.
void composite_lit(const Look& look, const Stretch& s, float lo, float hi, const Lit& first, const Lit& last, RayField& walker, int cuts,
                   RayState& state) {
  const float depth = float(s.to - s.from) * look.medium.most_tau(lo, hi);
  const float weight = state.sum.transmittance * std::min(depth, 1.0f);
  const float change = std::abs(last.diffuse - first.diffuse) + std::abs(last.specular - first.specular);
  if (cuts < most_cuts && weight * change > 0.25f * float(look.budget.tolerance)) {
    const double middle = 0.5 * (s.from + s.to);
    const Lit there = light_at(*look.lit, walker.gradient(s, middle), look.edge, look.per_scale);
    const float off = std::abs(there.diffuse - 0.5f * (first.diffuse + last.diffuse)) +
                      std::abs(there.specular - 0.5f * (first.specular + last.specular));
    if (cuts == 0 || weight * off > 0.1f * float(look.budget.tolerance)) {
      const Stretch a = part_of(s, s.from, middle), b = part_of(s, middle, s.to);
      if (!look.medium.clear(a.lowest(), a.highest()))
        composite_lit(look, a, a.lowest(), a.highest(), first, there, walker, cuts + 1, state);
      if (!look.medium.clear(b.lowest(), b.highest()))
        composite_lit(look, b, b.lowest(), b.highest(), there, last, walker, cuts + 1, state);
      return;
    }
  }
  Pieces pieces(look, state);
  const LitPart part{s.from, s.to, first, last};
  pieces.lit = &part;
  pieces.whole(s, lo, hi);
}

}  // namespace

void composite(const Look& look, const Stretch& s, RayField& walker, RayState& state) {
  const float lo = s.lowest(), hi = s.highest();
  if (!(lo <= hi) || look.medium.clear(lo, hi)) return;
  if (!look.lit) return Pieces(look, state).whole(s, lo, hi);
  const Lit first = light_at(*look.lit, walker.gradient(s, s.from), look.edge, look.per_scale);
  const Lit last = light_at(*look.lit, walker.gradient(s, s.to), look.edge, look.per_scale);
  composite_lit(look, s, lo, hi, first, last, walker, 0, state);
}

void composite_straight(const Look& look, double from, double to, float a, float b, const Lit* lit, RayState& state) {
  Pieces pieces(look, state);
  LitPart part;
  if (lit) part = {from, to, *lit, *lit}, pieces.lit = &part;
  pieces.straight(from, float(to - from), a, b);
}

void composite_sample(const Look& look, double from, double length, float value, const Lit* lit, RayState& state) {
  composite_straight(look, from, from + length, value, value, lit, state);
}

void composite_joint(const std::vector<Joint>& joint, RayState& state, int cuts) {
  const double from = joint[0].stretch.from, to = joint[0].stretch.to;
  double depth = 0, densest = 0;
  Vec3 glow{0, 0, 0};
  bool simple = true;
  uint32_t id = 0;
  float stop = 0, tolerance = 1;
  for (const Joint& j : joint) {
    const Stretch& s = j.stretch;
    const Medium& medium = j.look->medium;
    stop = std::max(stop, j.look->budget.stop_below), tolerance = std::min(tolerance, float(j.look->budget.tolerance));
    const float lo = s.lowest(), hi = s.highest();
    if (!(lo <= hi) || medium.clear(lo, hi)) continue;
    simple = simple && medium.line_of(lo) == medium.line_of(hi);
    const float mean = 0.25f * (s.b[0] + s.b[1] + s.b[2] + s.b[3]);
    const Optics o = medium.at(mean);
    const double d = (to - from) * std::max(0.0, double(o.tau));
    if (!(d > 0)) continue;
    Lit lit;
    if (j.look->lit) lit = light_at(*j.look->lit, j.walker->gradient(s, 0.5 * (from + to)), j.look->edge, j.look->per_scale);
    depth += d;
    glow += Vec3{o.r * lit.diffuse + lit.specular, o.g * lit.diffuse + lit.specular, o.b * lit.diffuse + lit.specular} * d;
    if (d > densest) densest = d, id = j.look->id;
  }
  if (depth == 0 && simple) return;
  if (cuts < 10 && (!simple || double(state.sum.transmittance) * std::min(depth * depth, 1.0) > double(tolerance))) {
    const double middle = 0.5 * (from + to);
    std::vector<Joint> half = joint;
    for (Joint& j : half) j.stretch = part_of(j.stretch, from, middle);
    composite_joint(half, state, cuts + 1);
    if (state.sum.transmittance < stop) return;
    for (size_t i = 0; i < half.size(); ++i) half[i].stretch = part_of(joint[i].stretch, middle, to);
    return composite_joint(half, state, cuts + 1);
  }
  if (depth == 0) return;
  glow = glow / depth;
  const float alpha = 1 - exp_minus(float(depth));
  state.sum.behind(float(glow.x) * alpha, float(glow.y) * alpha, float(glow.z) * alpha, alpha);
  if (state.surface < 0 && state.sum.transmittance < 0.5f) state.surface = 0.5 * (from + to), state.surface_id = id;
}

}  // namespace sg::volume
