// SPDX-License-Identifier: Apache-2.0
// Several media at once along a ray: their emissions and absorptions add up at every place.
#include <algorithm>
#include <array>
#include <cmath>

#include "render/volume/rays/joint.h"
#include "render/volume/rays/light_kinks.h"

namespace sg::volume {

namespace {

constexpr int most_cuts = 14;
/// Optical depth from which on a part is cut whatever its samples say, times the light that it takes; and from which on samples may all lie
/// behind what is seen, so that they agree on nothing.
constexpr double most_depth = 1, blind_depth = 8;

/// Gauss's three places in [0, 1], their weights, and those of the integral from 0 to each place of the parabola through all three
/// (collocation: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.7).
constexpr double root = 0.3872983346207417;  // sqrt(15) / 10
constexpr double places[3] = {0.5 - root, 0.5, 0.5 + root};
constexpr double weights[3] = {5.0 / 18, 4.0 / 9, 5.0 / 18};
constexpr double until[3][3] = {{5.0 / 36, 2.0 / 9 - 2 * root / 3, 5.0 / 36 - root / 3},
                                {5.0 / 36 + 5 * root / 12, 2.0 / 9, 5.0 / 36 - 5 * root / 12},
                                {5.0 / 36 + root / 3, 2.0 / 9 + 2 * root / 3, 5.0 / 36}};

/// Light that a part sends to its front, and its optical depth.
struct Glow {
  Vec3 color{0, 0, 0};
  double depth = 0;
  uint32_t id = 0;  // of the densest medium

  Glow before(const Glow& behind) const {
    return {color + behind.color * std::exp(-depth), depth + behind.depth, depth >= behind.depth ? id : behind.id};
  }
};
double difference(const Glow& a, const Glow& b) {
  const Vec3 c = a.color - b.color;
  return std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z), std::abs(std::exp(-a.depth) - std::exp(-b.depth))});
}

class JointPart {
 public:
  JointPart(const std::vector<Joint>& joint, RayState& state) : joint_(joint), state_(state) {
    for (const Joint& j : joint) {
      const Look& look = *j.look;
      stop_ = std::max(stop_, look.budget.stop_below), tolerance_ = std::min(tolerance_, look.budget.tolerance);
      const float lo = j.stretch.lowest(), hi = j.stretch.highest();
      const bool clear = look.detail ? !(look.detail->ink > 0) && look.detail->transfer.clear(lo, hi) : look.medium.clear(lo, hi);
      if (!(lo <= hi) || clear) continue;
      media_.push_back(&j);
      detailed_ = detailed_ || look.detail, lit_ = lit_ || look.lit;
    }
  }

  void whole() {
    if (media_.empty()) return;
    const double from = joint_[0].stretch.from, to = joint_[0].stretch.to;
    std::vector<double> ends{from, to};
    for (const Joint* j : media_) {
      if (!j->look->detail) knots(*j, ends);
      if (!j->look->lit || !has_kinks(*j->look->lit)) continue;
      const LightKinks kinks = light_kinks(*j->look->lit, *j->walker, j->stretch);
      ends.insert(ends.end(), kinks.at, kinks.at + kinks.count);
    }
    std::sort(ends.begin(), ends.end());
    for (size_t i = 0; i + 1 < ends.size(); ++i) {
      if (!(ends[i + 1] > ends[i])) continue;
      part(ends[i], ends[i + 1], glow(ends[i], ends[i + 1]), 0);
      if (state_.sum.transmittance < stop_) return;
    }
  }

 private:
  /// Appends where the value turns, and where it meets a knot of the medium.
  static void knots(const Joint& j, std::vector<double>& ends) {
    const Stretch& s = j.stretch;
    const double b[4] = {double(s.b[0]), double(s.b[1]), double(s.b[2]), double(s.b[3])};
    const auto value = [&](double f) {
      const double g = 1 - f;
      return g * g * g * b[0] + 3 * g * f * (g * b[1] + f * b[2]) + f * f * f * b[3];
    };
    // Roots of the derivative p + 2 q f + r f^2 (a third of it).
    const double p = b[1] - b[0], q = b[2] - b[1] - p, r = b[3] - b[2] - 2 * (b[2] - b[1]) + p, root = q * q - p * r;
    std::vector<double> turns{0};
    if (root > 0) {
      const double sum = -(q + std::copysign(std::sqrt(root), q));
      double f[2] = {r != 0 ? sum / r : -1, sum != 0 ? p / sum : -1};
      std::sort(f, f + 2);
      for (double x : f)
        if (x > 0 && x < 1) turns.push_back(x), ends.push_back(s.from + (s.to - s.from) * x);
    }
    turns.push_back(1);
    const std::vector<Medium::Line>& lines = j.look->medium.lines();
    for (size_t k = 0; k + 1 < turns.size(); ++k) {
      const double a = value(turns[k]), c = value(turns[k + 1]), lo = std::min(a, c), hi = std::max(a, c);
      if (!(lo < hi)) continue;
      double from = turns[k];
      const int first = j.look->medium.line_of(float(lo)), last = j.look->medium.line_of(float(hi));
      const bool up = c > a;
      for (int n = first; n < last; ++n) {
        const auto knot = double(lines[size_t(up ? n : last - 1 - (n - first))].hi);
        if (!(knot > lo && knot < hi)) continue;
        from = meets(value, from, turns[k + 1], knot);
        ends.push_back(s.from + (s.to - s.from) * from);
      }
    }
  }
  /// Where a function that goes one way meets a value: false position, and halving where that is slow.
  template <class F>
  static double meets(const F& value, double a, double b, double knot) {
    double fa = value(a) - knot, fb = value(b) - knot;
    for (int i = 0; i < 60 && b - a > 1e-12 && fa != 0 && fb != 0; ++i) {
      const double even = a - fa * (b - a) / (fb - fa), x = i % 3 == 2 || !(even > a && even < b) ? 0.5 * (a + b) : even;
      const double fx = value(x) - knot;
      if ((fx < 0) == (fa < 0)) a = x, fa = fx;
      else b = x, fb = fx;
    }
    return std::abs(fa) < std::abs(fb) ? a : b;
  }

  struct Sample {
    double tau = 0;
    Vec3 glow{0, 0, 0};
    double densest = 0;
    uint32_t id = 0;
  };
  Sample sample(double t) const {
    Sample sum;
    for (const Joint* j : media_) {
      const Look& look = *j->look;
      double tau = 0;
      if (look.detail) {
        const Place p = place_at(look, j->stretch, t, *j->walker);
        tau = double(p.tau), sum.glow += Vec3(p.glow);
      } else {
        const Optics o = look.medium.at(j->stretch.value(t));
        if (!(o.tau > 0)) continue;
        const Lit lit = look.lit ? light_on(look, *j->walker, j->stretch, t) : Lit{};
        tau = double(o.tau) * double(lit.opacity), sum.glow += Vec3(lit.color(o.color)) * tau;
      }
      sum.tau += tau;
      if (tau > sum.densest) sum.densest = tau, sum.id = look.id;
    }
    return sum;
  }

  Glow glow(double from, double to) const {
    const double length = to - from;
    Sample s[3];
    Glow out;
    for (int i = 0; i < 3; ++i) s[i] = sample(from + places[i] * length), out.depth += length * weights[i] * s[i].tau;
    if (!(out.depth > 0)) return out;
    double densest = 0;
    for (int i = 0; i < 3; ++i) {
      const double depth = length * (until[i][0] * s[0].tau + until[i][1] * s[1].tau + until[i][2] * s[2].tau);
      out.color += s[i].glow * (length * weights[i] * std::exp(-std::max(depth, 0.0)));
      if (s[i].densest > densest) densest = s[i].densest, out.id = s[i].id;
    }
    return out;
  }

  /// Whether a medium that depends on more than the value may have been missed.
  bool overlook(double from, double to) const {
    return std::any_of(media_.begin(), media_.end(), [&](const Joint* j) {
      if (!j->look->detail) return false;
      const auto at = [&](double t) { return place_at(*j->look->detail, j->stretch, t, *j->walker); };
      return overlooks(*j->look->detail, to - from, at(from), at(0.5 * (from + to)), at(to));
    });
  }

  void part(double from, double to, const Glow& one, int cuts) {
    const double middle = 0.5 * (from + to), pass = double(state_.sum.transmittance);
    const Glow first = glow(from, middle), second = glow(middle, to), both = first.before(second);
    if (cuts < most_cuts) {
      const double taken = std::min(1.0, std::max(one.depth, both.depth));
      const double allowed = tolerance_ * (0.25 * (to - from) / joint_[0].look->budget.length + 0.25 * pass * taken);
      // Nine places tell little of what depends on more than the value.
      const bool few = detailed_ && cuts < 3;
      const bool hidden = both.depth > blind_depth && pass > 0.1 * tolerance_;
      if (few || hidden || pass * difference(one, both) > (detailed_ ? 0.3 : 1.0) * allowed || pass * taken * both.depth > most_depth ||
          (detailed_ && overlook(from, to))) {
        part(from, middle, first, cuts + 1);
        if (state_.sum.transmittance < stop_) return;
        return part(middle, to, second, cuts + 1);
      }
    }
    if (!(both.depth > 0)) return;
    Gathered& sum = state_.sum;
    const double after = pass * std::exp(-both.depth);
    Vec3 color = both.color;
    if (cuts == most_cuts && both.depth > 0.5) {
      // Still dense, as opacity 1 is: nine places do not tell where the light goes, but all of it goes here.
      // Values are floats: a knot may lie a little beside where it should, and only part of this be dense.
      Sample s;
      for (double begin : {from, middle})
        for (double place : places)
          if (const Sample there = sample(begin + place * 0.5 * (to - from)); there.tau > s.tau) s = there;
      if (s.tau > 0) color = s.glow * (-std::expm1(-both.depth) / s.tau);
    }
    sum.r += float(pass * color.x), sum.g += float(pass * color.y), sum.b += float(pass * color.z);
    sum.transmittance = float(after);
    if (state_.surface < 0 && after < 0.5) {
      // As if the media were even.
      const double gone = pass > 0.5 ? std::log(2 * pass) / both.depth : 0;
      state_.surface = from + (to - from) * std::min(gone, 1.0), state_.surface_id = both.id;
    }
  }

  const std::vector<Joint>& joint_;
  RayState& state_;
  std::vector<const Joint*> media_;  // that draw something here
  float stop_ = 0;
  double tolerance_ = 1;
  bool detailed_ = false, lit_ = false;
};

}  // namespace

void composite_joint(const std::vector<Joint>& joint, RayState& state) { JointPart(joint, state).whole(); }

}  // namespace sg::volume
