// SPDX-License-Identifier: Apache-2.0
#include "render/volume/rays/integrate.h"
#include "render/shade/exp.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "render/volume/effects/effects.h"
#include "render/volume/medium/color_between.h"
#include "render/volume/medium/transfer.h"
#include "render/volume/rays/functions.h"
#include "render/volume/rays/joint.h"
#include "render/volume/rays/light_kinks.h"

namespace sg::volume {

namespace {

Lit light_on(const Look& look, RayField& walker, const Stretch& s, double t, Vec3f& gradient) {
  const LightEffects* effects = look.lit->effects;
  gradient = !effects || effects->needs_gradient(look.lit->material.lit) ? walker.gradient(s, t) : Vec3f{0, 0, 0};
  return effects ? light_at(*look.lit, t, gradient, look.edge, look.per_scale) : light_at(*look.lit, gradient, look.edge, look.per_scale);
}

}  // namespace

Lit light_on(const Look& look, RayField& walker, const Stretch& s, double t) {
  Vec3f gradient;
  return light_on(look, walker, s, t, gradient);
}

namespace {

constexpr float deep = 0.05f;   // optical depth from which on the order within a segment is seen
constexpr float solid = 16.0f;  // and from which on its front alone is

/// How far into a part of optical depth D one sees, as a share of its length: a mean free path, D f (2 (1 - r) + (2 r - 1) f) = 1, for a
/// density that goes in a straight line so that its centroid is at `weight` (r is the share of the far end, 3 weight - 1).
float sight(float depth, float weight) {
  const float r = std::clamp(3 * weight - 1, 0.0f, 1.0f), near = 1 - r;
  return 1 / (depth * (near + std::sqrt(near * near + (2 * r - 1) / depth)));
}

/// Where there is light on the ends of a part of a stretch, linear between them.
struct LitPart {
  double from, to;
  Lit first, last;
  Lit at(double t) const { return lerp(first, last, to > from ? float((t - from) / (to - from)) : 0); }
  /// What colours are multiplied by changes by so much over a length.
  float brighter(float length) const { return to > from ? (last.diffuse - first.diffuse) * (length / float(to - from)) : 0; }
};

/// The variance of where in a part of so much depth light comes from that is seen: 1/D^2 - exp(-D)/A^2, by its series where that cancels.
float spread(float depth, float alpha, float pass) {
  const float square = depth * depth;
  return depth < 1 ? (1 - square * (0.05f - square * (1.0f / 504))) * (1.0f / 12) : 1 / square - pass / (alpha * alpha);
}

class Pieces {
 public:
  Pieces(const Look& look, RayState& state) : look_(look), state_(state), covary_from_(float(0.2 * look.budget.tolerance)) {}

  const LitPart* lit = nullptr;

  void light(const LitPart& part) {
    lit = &part;
    denser_ = std::max(part.first.opacity, part.last.opacity);
    styled_ = part.first.opacity != 1 || part.last.opacity != 1;
  }

  /// A part of optical depth D: the value goes from a to b, `mean` is its mean by emission, which lies `weight` of the way on. C = c(mean)
  /// A less what the front hides of the change of colour (exact for constant tau and a linear colour).
  void segment(double t, float length, float depth, float a, float b, float mean, float weight, int line) {
    if (!(depth > 0)) return;
    if (styled_) depth *= lit->at(t + double(length) * double(weight)).opacity;
    const float pass = exp_minus(depth), alpha = depth < 0.02f ? depth * (1 - depth * (0.5f - depth * (1.0f / 6))) : 1 - pass;
    const Medium& medium = look_.medium;
    const auto color = [&](float v) { return depth > solid ? color_between(medium, line, v) : medium.color(v, line); };
    Vec3f c = color(mean) * alpha, both{0, 0, 0};
    const float brighter = lit ? lit->brighter(length) : 0;
    const bool together = lit && std::abs(brighter) * medium.color_slope() * std::abs(medium.axis(b) - medium.axis(a)) > covary_from_;
    if (depth > solid) {
      weight = sight(depth, weight);
      c = color(a + (b - a) * weight) * alpha;
    } else if (depth > deep || together) {
      // A/2 - A/D + exp(-D), by its series where that cancels.
      const float hidden =
          depth < 0.2f ? depth * depth * (1.0f / 12 - depth * (1.0f / 24 - depth * (1.0f / 80))) : 0.5f * alpha - alpha / depth + pass;
      const Vec3f change = color(b) - color(a);
      c -= change * hidden;
      weight -= hidden / alpha;
      if (together) both = change * (alpha * brighter * spread(depth, alpha, pass));
    }
    if (lit) {
      const Lit l = lit->at(t + double(length) * double(weight));
      const float flash = l.specular * alpha;
      c = c * l.diffuse + Vec3f{flash, flash, flash} + both;
      if (look_.lit->effects) c += l.tint * alpha;
    }
    Gathered& sum = state_.sum;
    const float before = sum.transmittance;
    sum.r += before * c.x, sum.g += before * c.y, sum.b += before * c.z;
    sum.transmittance = before * pass;
    if (state_.surface < 0 && sum.transmittance < 0.5f) {
      // tau as good as constant: half of the light is gone at the share ln(2 before)/depth of the way.
      const double gone = before > 0.5f ? std::log(2.0 * double(before)) / double(depth) : 0;
      state_.surface = t + double(length) * std::min(gone, 1.0), state_.surface_id = look_.id;
    }
  }

  /// The shares [f0, f1] of a stretch of which line `i` is the medium. Simpson's rule: exact for the optical depth of a cubic.
  void piece(const Stretch& s, float f0, float f1, float a, float b, int i) {
    const Medium::Line& line = look_.medium.lines()[size_t(i)];
    const float middle = value(s, 0.5f * (f0 + f1)), length = float(s.to - s.from) * (f1 - f0);
    const float t0 = line(a), tm = 4 * line(middle), t1 = line(b), all = t0 + tm + t1;
    if (!(all > 0)) return;
    const float mean = (t0 * a + tm * middle + t1 * b) / all, weight = (0.5f * tm + t1) / all;
    segment(s.from + (s.to - s.from) * double(f0), length, length * (all * (1.0f / 6)), a, b, mean, weight, i);
  }

  static float value(const Stretch& s, float f) { return value(s.b, f); }
  static float value(const float b[4], float f) {
    const float g = 1 - f;
    const float b01 = g * b[0] + f * b[1], b12 = g * b[1] + f * b[2], b23 = g * b[2] + f * b[3];
    return g * (g * b01 + f * b12) + f * (g * b12 + f * b23);
  }

  /// The share [f0, f1], on which the value goes one way from a to b: cut where it meets the knots of the medium.
  void monotone(const Stretch& s, float f0, float f1, float a, float b) {
    if (a != a || b != b) return;  // sums of values near the largest float may be no numbers
    const std::vector<Medium::Line>& lines = look_.medium.lines();
    int i = look_.medium.line_of(a);
    const bool up = b >= a;
    if (!up && i > 0 && lines[size_t(i)].lo == a) --i;
    for (float f = f0, v = a;;) {
      const Medium::Line& line = lines[size_t(i)];
      const bool last = up ? b <= line.hi : b >= line.lo;
      if (last) return piece(s, f, f1, v, b, i);
      const float knot = up ? line.hi : line.lo;
      const float at = meets(s, f, f1, v, b, knot);
      piece(s, f, at, v, knot, i);
      f = at, v = knot, i += up ? 1 : -1;
    }
  }

  /// Where the value meets a knot between f0 and f1, to `close_`: false position, twice corrected; where that does not do, false position
  /// that encloses the place and halves the share of an end that stays (Illinois).
  float meets(const Stretch& s, float f0, float f1, float a, float b, float knot) const {
    const float slope = (f1 - f0) / (b - a);
    float f = f0 + (knot - a) * slope, off = 0;
    for (int i = 0; i < 2; ++i) {
      off = value(s, f) - knot;
      f = std::clamp(f - off * slope, f0, f1);
    }
    if (std::abs(off) <= close_) return f;
    float at0 = a - knot, at1 = b - knot;
    f = (at0 * f1 - at1 * f0) / (at0 - at1);
    for (int i = 0, side = 0; i < 40; ++i) {
      f = std::clamp(f, f0, f1);
      const float here = value(s, f) - knot;
      if (std::abs(here) <= close_ || !(f > f0 && f < f1) || f1 - f0 < 1e-6f) break;
      if ((here > 0) == (at1 > 0)) {
        f1 = f, at1 = here;
        if (side == 1) at0 *= 0.5f;
        side = 1;
      } else {
        f0 = f, at0 = here;
        if (side == -1) at1 *= 0.5f;
        side = -1;
      }
      f = (at0 * f1 - at1 * f0) / (at0 - at1);
    }
    return f == f ? std::clamp(f, f0, f1) : f0;
  }

  void whole(const Stretch& s, float lo, float hi) {
    const Medium& medium = look_.medium;
    const float a = s.b[0], b = s.b[3], length = float(s.to - s.from), pass = state_.sum.transmittance;
    const float tolerance = float(look_.budget.tolerance);
    const float most = denser_ * medium.most_tau(lo, hi), slope = denser_ * medium.most_slope(lo, hi),
                taken = std::min(1.0f, length * most);
    const float widths = (medium.axis(hi) - medium.axis(lo)) / medium.color_width();
    const float colors = (medium.axis(hi) - medium.axis(lo)) * medium.color_slope(), recolor = std::min(1.0f, colors);
    const float change = recolor + (lit ? difference(lit->first, lit->last) : 0);
    // What one piece gets wrong: colours bend on a width, and at every octave of an axis that is not straight; in a deep piece the front
    // shows more of its own colour than a constant tau would have it, and than the mean of a value that bends (more than a whole change of
    // colour, too, where few pieces would have it). All fall with the square of the number of pieces.
    const float first = a - 2 * s.b[1] + s.b[2], last = s.b[1] - 2 * s.b[2] + b;
    const float bend = 3 * std::max(std::abs(first), std::abs(last));  // half of the largest second derivative, over the stretch
    const float depth = length * most, recolored = std::min(1e6f, hi > lo ? bend / (hi - lo) * colors : 0);
    // The colour at the middle of a bend is a third of its height beside the mean, and all of it beside what a straight line has at the
    // front.
    const float shown = taken * (1 + 0.25f * std::min(depth, 8.0f));
    float error = shown * (0.25f * tolerance) * widths * widths;
    if (!medium.linear() && std::floor(medium.axis(lo)) != std::floor(medium.axis(hi))) error += shown * recolor * (1.0f / 12);
    error += change * std::min(1.0f, 0.05f * length * depth * slope * (hi - lo));
    error += taken * recolored * std::min(1.0f / 6, depth * depth * (1.0f / 360));
    // Where tau rises Simpson's rule has the mean colour of a value that bends wrong by a 120th of the fourth power's factor in their
    // product, which falls with the fourth power.
    const float fourth = slope * (bend + 2 * std::abs(last - first) * (hi - lo) / std::max(bend, 1e-30f));
    const float leaning = std::min(120 * taken, denser_ * length * medium.leaning(slope, hi - lo, bend, std::abs(last - first)));
    const float uneven = pass * (std::min(1.0f, recolored) * std::min(1.0f, length * fourth) + leaning) * (1.0f / 120);
    const float share = pass * std::min(1.0f, denser_ * length * medium.tau(0.25f * (s.b[0] + s.b[1] + s.b[2] + s.b[3])));
    const float allowed = tolerance * (float(0.3 / look_.budget.length) * length + 0.4f * share);
    // And the value may turn beyond its ends, where there may be knots: then pieces end there, too.
    const float beyond = std::max(hi - std::max(a, b), std::min(a, b) - lo);
    const bool abrupt = medium.any_abrupt() && medium.abrupt(lo, hi);
    double turn[3] = {2, 2, 2};
    // What is wrong by how far a value lies beside a knot: of tau, and of colours.
    const float spoilt = pass * (length * slope + taken * (hi > lo ? recolor / (hi - lo) : 0));
    if (beyond > 0 && (abrupt || beyond * spoilt > 0.1f * allowed)) turn[turns(s.b, turn)] = 2;
    close_ = abrupt ? 0 : 0.05f * allowed / std::max(spoilt, 1e-30f);
    error *= pass;
    const float parts = std::max(std::sqrt(error / allowed), std::sqrt(std::sqrt(uneven / allowed)));
    const float n = std::clamp(std::ceil(parts), 1.0f, 1024.0f);
    float v = a, f = 0;
    const double* next_turn = turn;
    for (float k = 1; k <= n;) {
      float to = k == n ? 1 : k / n;
      const bool turning = float(*next_turn) < to;
      if (turning) to = float(*next_turn++);
      else ++k;
      const float next = to == 1 ? b : value(s, to);
      if (to > f) monotone(s, f, to, v, next);
      if (state_.sum.transmittance < look_.budget.stop_below) return;
      v = next, f = to;
    }
  }

 private:
  const Look& look_;
  RayState& state_;
  const float covary_from_;  // products of changes of colour and light that count
  float denser_ = 1;         // largest factor of tau by the light
  bool styled_ = false;      // is there one at all?
  float close_ = 0;          // so near to a knot a value counts as that
};

/// The light at a place of a ray, and the surface there.
struct LitPlace {
  double t = 0;
  Lit light;
  Vec3f gradient{0, 0, 0};
  Vec3f normal{0, 0, 0};  // unit, along the gradient; zero where there is none
  float along = 0;        // of the normal and the ray: the cosine
  float nearest = 0;      // the cosine to the nearest middle of a highlight
  uint32_t facing = 0;    // which lamps it faces
};

LitPlace lit_place(const Look& look, RayField& walker, const Stretch& s, double t) {
  LitPlace p;
  Vec3f gradient{0, 0, 0};
  p.t = t, p.light = light_on(look, walker, s, t, gradient), p.gradient = gradient;
  const float square = dot(gradient, gradient);
  if (!(square > 0 && square < 1e30f)) return p;
  p.normal = gradient * (1 / std::sqrt(square)), p.along = dot(p.normal, look.lit->direction);
  const float side = p.along > 0 ? -1.0f : 1.0f;
  for (size_t i = 0; i < look.lit->lights.size(); ++i)
    if (const SeenLamp& l = look.lit->lights[i]; side * dot(p.normal, l.light) > 0)
      p.nearest = std::max(p.nearest, side * dot(p.normal, l.half)), p.facing |= 1u << (i % 32);
  return p;
}

/// What light that is linear between two places may have wrong in between, besides what a look at the middle tells.
float may_bend(const LitRay& lit, const LitPlace& a, const LitPlace& b) {
  if (a.along == 0 || b.along == 0) return 0;
  const float turn = std::max(0.0f, 1 - dot(a.normal, b.normal));
  // So near to the surface's edge that it may turn over and back, a ray sees as much of its other side as it turns.
  const float over = std::min(std::abs(a.along), std::abs(b.along)) < turn ? std::min(turn, 1.0f) : 0;
  // A highlight is exp(-p x^2 / 2) at the angle x: its second derivative, at most, on an arc of `turn` (1 - cosine) from such a place.
  const float power = lit.material.power, away = std::sqrt(std::max(0.0f, 1 - std::max(a.nearest, b.nearest)));
  const float closest = std::max(0.0f, away - 0.5f * std::sqrt(turn)), fall = closest * closest;
  const float lobe = exp_minus(power * fall) * std::max(1.0f, 2 * power * fall);
  float all = 0;
  for (const SeenLamp& l : lit.lights) all += l.intensity;
  const float bend = all * (lit.material.diffuse + lit.material.specular * power * lobe);
  // Light bends sharply where a lamp begins to shine, or stops.
  const float kink = a.facing != b.facing ? 0.5f * difference(a.light, b.light) : 0;
  return std::max(over, turn * bend * (1.0f / 12)) + kink;
}

/// Integrates a stretch with light.
class LitStretch {
 public:
  LitStretch(const Look& look, RayField& walker, RayState& state) : look_(look), walker_(walker), state_(state) {}

  void whole(const Stretch& s, float lo, float hi) {
    const double beside = hair * (s.to - s.from);
    LitPlace first = lit_place(look_, walker_, s, s.from + beside), last = lit_place(look_, walker_, s, s.to - beside);
    first.t = s.from, last.t = s.to;
    const float depth = float(s.to - s.from) * look_.medium.most_tau(lo, hi), weight = state_.sum.transmittance * std::min(depth, 1.0f);
    LightKinks kinks;
    if (weight * most_jump() > allowed(s, weight)) kinks = light_kinks(*look_.lit, walker_, s, first.gradient, last.gradient);
    if (kinks.count == 0) return part(s, lo, hi, first, last, 0, unknown);
    LitPlace begin = first;
    for (int i = 0; i <= kinks.count; ++i) {
      // The light on both sides of a kink, which is the same place.
      LitPlace end = last, next = last;
      if (i < kinks.count) {
        end = lit_place(look_, walker_, s, std::max(s.from, kinks.at[i] - beside)),
        next = lit_place(look_, walker_, s, std::min(s.to, kinks.at[i] + beside));
        end.t = next.t = kinks.at[i];
      }
      within(s, begin, end, 0, unknown);
      if (state_.sum.transmittance < look_.budget.stop_below) return;
      begin = next;
    }
  }

 private:
  static constexpr int most_cuts = 10;
  static constexpr float unknown = 0.1f;  // what light may be off where it is known at two ends alone

  /// What may be wrong of a part: a share of the tolerance by the light that is taken, one by the length.
  float allowed(const Stretch& s, float weight) const {
    return float(look_.budget.tolerance) * (0.4f * weight + 0.4f * float((s.to - s.from) / look_.budget.length));
  }
  /// By how much light may jump where a surface turns over or a lamp begins to reach it.
  float most_jump() const {
    if (!has_kinks(*look_.lit)) return 0;
    float all = 0;
    for (const SeenLamp& l : look_.lit->lights) all += l.intensity;
    return all * (look_.lit->material.diffuse + look_.lit->material.specular);
  }
  /// Cuts the stretch until the light on its ends tells the light on its way. Ends may be alike by chance: `may_be_off` is what light in
  /// between may be off the straight line between them as far as is known.
  void part(const Stretch& s, float lo, float hi, const LitPlace& first, const LitPlace& last, int cuts, float may_be_off) {
    const float depth = float(s.to - s.from) * look_.medium.most_tau(lo, hi);
    const float weight = state_.sum.transmittance * std::min(depth, 1.0f);
    const float allowed = this->allowed(s, weight);
    const float bend = may_bend(*look_.lit, first, last), differ = std::max(bend, difference(first.light, last.light));
    // The ends of a whole stretch tell little of it, and its middle little where a short way in it is all that is seen.
    if (cuts == 1 && depth > 1) may_be_off = std::max(may_be_off, unknown);
    const bool dense = cuts == 0 && depth > 2;
    if (cuts < most_cuts && weight * std::max(differ, may_be_off) > allowed) {
      const LitPlace middle = lit_place(look_, walker_, s, 0.5 * (s.from + s.to));
      const float off = difference(middle.light, lerp(first.light, last.light, 0.5f));
      if (dense || weight * std::max(off, bend) > allowed) {
        LitPlace before = middle, after = middle;
        if (jumps(s, first, middle, last, before, after)) {
          within(s, first, before, cuts + 1, 0);
          return within(s, after, last, cuts + 1, 0);
        }
        // What bends evenly is off by a fourth on either half.
        within(s, first, middle, cuts + 1, 0.25f * off);
        return within(s, middle, last, cuts + 1, 0.25f * off);
      }
    }
    Pieces pieces(look_, state_);
    const LitPart lit{s.from, s.to, first.light, last.light};
    pieces.light(lit);
    pieces.whole(s, lo, hi);
  }
  void within(const Stretch& s, const LitPlace& first, const LitPlace& last, int cuts, float may_be_off) {
    if (!(last.t > first.t)) return;
    const Stretch p = part_of(s, first.t, last.t);
    const float lo = p.lowest(), hi = p.highest();
    if (!look_.medium.clear(lo, hi)) part(p, lo, hi, first, last, cuts, may_be_off);
  }

  /// Whether the light jumps, as where a surface turns over; then between two adjacent samples, which count as one.
  bool jumps(const Stretch& s, const LitPlace& first, const LitPlace& middle, const LitPlace& last, LitPlace& before,
             LitPlace& after) const {
    const float all = difference(first.light, last.light), front = difference(first.light, middle.light),
                back = difference(middle.light, last.light);
    if (!(std::max(front, back) > 0.7f * all && std::min(front, back) < 0.3f * all)) return false;
    before = front > back ? first : middle, after = front > back ? middle : last;
    for (int n = 0; n < 14; ++n) {
      const LitPlace there = lit_place(look_, walker_, s, 0.5 * (before.t + after.t));
      const bool later = difference(before.light, there.light) < difference(there.light, after.light);
      (later ? before : after) = there;
      if (difference(before.light, after.light) < 0.5f * all) return false;
    }
    after.t = before.t;
    return true;
  }

  const Look& look_;
  RayField& walker_;
  RayState& state_;
};

}  // namespace

Place place_at(const Look& look, const Stretch& s, double t, RayField& walker) {
  const Detail& detail = *look.detail;
  Place p{place_at(detail, s, t, walker), {}};
  const Vec3f color{p.sample.r, p.sample.g, p.sample.b};
  p.glow = color * p.tau;
  if (look.lit && (p.tau > 0 || detail.ink > 0)) {
    const Lit l = light_on(look, walker, s, t);
    p.tau *= l.opacity, p.glow = l.color(color) * p.tau;
    // Ink is black, in the distance as the background.
    const float ink = detail.ink * l.ink;
    p.tau += ink;
    if (look.lit->effects && ink > 0)
      p.glow += look.lit->background * (ink * look.lit->effects->fade(look.lit->origin + look.lit->along * t));
  }
  return p;
}

namespace {

void composite_detailed(const Look& look, const Stretch& s, double from, double to, const Place& a, const Place& b, RayField& walker,
                        int cuts, float inherited, RayState& state) {
  if (state.sum.transmittance < look.budget.stop_below) return;
  const double middle = 0.5 * (from + to);
  const Place m = place_at(look, s, middle, walker);
  const float length = float(to - from);
  const auto simpson = [length](float x, float y, float z) { return length / 6 * (x + 4 * y + z); };
  const float depth = simpson(a.tau, m.tau, b.tau), rough = 0.25f * length * (a.tau + 2 * m.tau + b.tau);
  const Vec3f glow{simpson(a.glow.x, m.glow.x, b.glow.x), simpson(a.glow.y, m.glow.y, b.glow.y), simpson(a.glow.z, m.glow.z, b.glow.z)};
  const Vec3f rough_glow = (a.glow + m.glow * 2 + b.glow) * (0.25f * length);
  // Three samples may lie on a line by chance: what is smooth is wrong by an eighth of what the whole was, so a part of that counts.
  const float off = std::max({inherited * (1.0f / 64), std::abs(depth - rough), std::abs(glow.x - rough_glow.x),
                              std::abs(glow.y - rough_glow.y), std::abs(glow.z - rough_glow.z)});
  const float pass = state.sum.transmittance, taken = std::min(1.0f, depth);
  const float allowed = float(look.budget.tolerance) * (0.3f * float(length / look.budget.length) + 0.15f * pass * taken);
  // The order of colours within a deep part, too.
  const bool order = depth > 0.1f && pass * taken > float(look.budget.tolerance);
  // Three samples tell little of what is light.
  const bool few = cuts == 0 && pass * taken > 0.1f * float(look.budget.tolerance);
  if (cuts < 10 && (pass * std::min(off, 1.0f) > allowed || order || few || overlooks(*look.detail, double(length), a, m, b))) {
    composite_detailed(look, s, from, middle, a, m, walker, cuts + 1, off, state);
    return composite_detailed(look, s, middle, to, m, b, walker, cuts + 1, off, state);
  }
  if (!(depth > 0)) return;
  const float alpha = 1 - exp_minus(depth), per = alpha / depth;
  state.sum.behind(glow.x * per, glow.y * per, glow.z * per, alpha);
  if (state.surface < 0 && state.sum.transmittance < 0.5f) state.surface = middle, state.surface_id = look.id;
}

}  // namespace

void composite(const Look& look, const Stretch& s, RayField& walker, RayState& state) {
  const float lo = s.lowest(), hi = s.highest();
  if (look.detail) {
    if (!(lo <= hi) || (!(look.detail->ink > 0) && look.detail->transfer.clear(lo, hi))) return;
    LightKinks kinks;
    if (look.lit && has_kinks(*look.lit)) kinks = light_kinks(*look.lit, walker, s);
    double from = s.from;
    for (int i = 0; i <= kinks.count; ++i) {
      const double to = i < kinks.count ? kinks.at[i] : s.to, beside = hair * (to - from);
      if (!(to > from)) continue;
      const Place a = place_at(look, s, from + beside, walker), b = place_at(look, s, to - beside, walker);
      composite_detailed(look, s, from, to, a, b, walker, 0, 0, state);
      from = to;
    }
    return;
  }
  if (!(lo <= hi) || look.medium.clear(lo, hi)) return;
  if (!look.lit) return Pieces(look, state).whole(s, lo, hi);
  LitStretch(look, walker, state).whole(s, lo, hi);
}

void composite_straight(const Look& look, double from, double to, float a, float b, const Lit* lit, RayState& state) {
  Pieces pieces(look, state);
  LitPart part;
  if (lit) part = {from, to, *lit, *lit}, pieces.light(part);
  const float third = (b - a) / 3;
  pieces.monotone({from, to, {a, a + third, b - third, b}}, 0, 1, a, b);
}

void composite_sample(const Look& look, double from, double length, float value, const Lit* lit, RayState& state) {
  composite_straight(look, from, from + length, value, value, lit, state);
}

void composite_optics(const Look& look, double from, double length, const Optics& optics, const Lit* lit, RayState& state) {
  const float alpha = 1 - exp_minus(optics.tau * float(length));
  if (!(alpha > 0)) return;
  const Lit l = lit ? *lit : Lit{};
  const Vec3f c = l.color(optics.color) * alpha;
  state.sum.behind(c.x, c.y, c.z, alpha);
  if (state.surface < 0 && state.sum.transmittance < 0.5f) state.surface = from + 0.5 * length, state.surface_id = look.id;
}

void composite_segment(const Look& look, double from, double length, const Preintegrated::Segment& segment, const Lit* lit,
                       RayState& state) {
  if (!(segment.depth > 0)) return;
  const Lit l = lit ? *lit : Lit{};
  const float plain = 1 - exp_minus(segment.depth), alpha = l.opacity == 1 ? plain : 1 - exp_minus(segment.depth * l.opacity);
  if (!(plain > 0)) return;
  const Vec3f c = l.color(segment.color * (1 / plain)) * alpha;
  state.sum.behind(c.x, c.y, c.z, alpha);
  if (state.surface < 0 && state.sum.transmittance < 0.5f) state.surface = from + 0.5 * length, state.surface_id = look.id;
}

}  // namespace sg::volume
