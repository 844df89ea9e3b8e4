// SPDX-License-Identifier: Apache-2.0
// The tests' own integral of emission and absorption, in double and independent of the renderer: transfer functions from their points,
// fields that are told by place, and an integral that looks at a 64th of a cell first and cuts wherever something may be missed.
//
// What it is an integral of: C = integral of c tau exp(-integral tau), tau = -ln(1 - opacity)/unit (Max 1995), colours in linear light,
// lit as light_model.h says.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "base/vec.h"
#include "color/color_scale.h"

namespace sg::test {

inline double srgb_decoded(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

/// Opacity and colour over the value, from the points and stops themselves.
struct TrueTransfer {
  struct Stop {
    double at;  ///< position on the scale
    Vec3 srgb;
  };
  std::vector<Vec2> opacity;
  std::vector<Stop> stops;
  double lo = 0, hi = 1;  ///< of the scale
  ScaleKind kind = ScaleKind::linear;
  double threshold = 1;  ///< of symlog
  bool clamp = true;     ///< false: nothing is drawn beyond lo and hi
  double unit = 1;

  double on_axis(double v) const {
    if (kind == ScaleKind::linear) return v;
    if (kind == ScaleKind::log) return v > 0 ? std::log(v) : -1e300;
    const double a = std::abs(v) / threshold;
    return a <= 1 ? v / threshold : std::copysign(1 + std::log10(a), v);
  }
  double from_axis(double a) const {
    if (kind == ScaleKind::linear) return a;
    if (kind == ScaleKind::log) return std::exp(a);
    return std::abs(a) <= 1 ? a * threshold : std::copysign(threshold * std::pow(10, std::abs(a) - 1), a);
  }
  double position(double v) const { return (on_axis(v) - on_axis(lo)) / (on_axis(hi) - on_axis(lo)); }
  double value_at(double p) const { return p == 0 ? lo : p == 1 ? hi : from_axis(on_axis(lo) + p * (on_axis(hi) - on_axis(lo))); }

  /// Values between which opacity is one straight line and colours do not bend or jump, ascending.
  std::vector<double> knots() const {
    std::vector<double> k;
    for (const Vec2& p : opacity) k.push_back(p.x);
    for (const Stop& s : stops) k.push_back(value_at(s.at));
    k.push_back(lo), k.push_back(hi);
    std::sort(k.begin(), k.end());
    k.erase(std::unique(k.begin(), k.end()), k.end());
    return k;
  }
  /// Of the straight line on which `inside` lies, at v; two points at one place have none.
  double opacity_on(double inside, double v) const {
    if (!clamp && (inside < lo || inside > hi)) return 0;
    if (inside < opacity.front().x) return opacity.front().y;
    for (size_t i = 1; i < opacity.size(); ++i)
      if (inside < opacity[i].x) {
        const Vec2 a = opacity[i - 1], b = opacity[i];
        return std::clamp(a.y + (b.y - a.y) * ((v - a.x) / (b.x - a.x)), std::min(a.y, b.y), std::max(a.y, b.y));
      }
    return opacity.back().y;
  }
  /// Linear light.
  Vec3 color_on(double inside, double v) const {
    const double where = position(inside), p = position(v);
    Vec3 c = stops.back().srgb;
    if (where < stops.front().at) c = stops.front().srgb;
    else
      for (size_t i = 1; i < stops.size(); ++i)
        if (where < stops[i].at) {
          const Stop &a = stops[i - 1], &b = stops[i];
          c = a.srgb + (b.srgb - a.srgb) * std::clamp((p - a.at) / (b.at - a.at), 0.0, 1.0);
          break;
        }
    return {srgb_decoded(c.x), srgb_decoded(c.y), srgb_decoded(c.z)};
  }
  double opaque = 1e12;  ///< depth of opacity 1 over a unit
  /// Mean of tau while opacity goes straight from a to b: -(ln(1 - o)) has the integral (1 - o) ln(1 - o) + o.
  double mean_tau(double a, double b) const {
    const auto whole = [](double o) { return o < 1 ? (1 - o) * std::log1p(-o) + o : 1.0; };
    if (std::abs(b - a) > 1e-4) return (whole(b) - whole(a)) / (b - a) / unit;
    if (a >= 1 && b >= 1) return opaque / unit;
    return -std::log1p(-std::min(0.5 * (a + b), 1 - 1e-16)) / unit;
  }
};

/// A lamp, in world space, and what materials make of it.
struct TrueLamp {
  Vec3 towards;
  double intensity;
};
struct TrueLight {
  double ambient, diffuse, specular, power;
  std::vector<TrueLamp> lamps;
  double surface_from;  ///< length of the gradient from which on there is a surface
  double edge_on = 0;   ///< cosine of ray and gradient above which the other side is seen: 0, or as near to it as floats tell
};

/// A volume along one ray.
struct TrueVolume {
  const TrueTransfer* transfer;
  std::vector<double> knots;
  std::function<double(double t)> value;   ///< NaN where there is none
  std::function<Vec3(double t)> gradient;  ///< asked for where it is lit
  const TrueLight* light = nullptr;        ///< null = not lit
  std::vector<double> ends;                ///< t between which the value is smooth, ascending: cells, say
};

/// What passes is `pass`.
struct TrueSum {
  Vec3 color{0, 0, 0};
  double pass = 1;
};

class TrueRay {
 public:
  TrueRay(std::vector<TrueVolume> volumes, Vec3 direction, int pieces) : v_(std::move(volumes)), direction_(direction), pieces_(pieces) {}

  TrueSum integrate(double from, double to) {
    std::vector<double> ends{from, to};
    for (const TrueVolume& v : v_) ends.insert(ends.end(), v.ends.begin(), v.ends.end());
    std::sort(ends.begin(), ends.end());
    for (size_t i = 0; i + 1 < ends.size() && sum_.pass > 1e-7; ++i) {
      // A hair away from the ends, so that a place lies in one cell for sure.
      const double a = std::max(from, ends[i]), b = std::min(to, ends[i + 1]), air = 1e-9 * (b - a);
      if (!(b - a > 1e-13 * (to - from))) continue;
      const double h = (b - a - 2 * air) / pieces_;
      Place p = at(a + air);
      for (int k = 0; k < pieces_ && sum_.pass > 1e-7; ++k) {
        const Place q = at(a + air + (k + 1) * h);
        piece(p, at(a + air + (k + 0.5) * h), q, 0);
        p = q;
      }
    }
    return sum_;
  }

 private:
  static constexpr size_t most = 2;
  struct Glow {
    double diffuse = 1, specular = 0;
  };
  struct Place {
    double t = 0;
    std::array<double, most> value{};
    std::array<Glow, most> glow{};
    bool lit = false;
  };

  Place at(double t) const {
    Place p;
    p.t = t;
    for (size_t i = 0; i < v_.size(); ++i) p.value[i] = v_[i].value(t);
    return p;
  }
  void light(Place& p) const {
    if (p.lit) return;
    p.lit = true;
    for (size_t i = 0; i < v_.size(); ++i) {
      if (!v_[i].light || p.value[i] != p.value[i]) continue;
      const TrueLight& l = *v_[i].light;
      const Vec3 g = v_[i].gradient(p.t);
      const double size = length(g);
      if (!(size > 0)) continue;
      const double surface = std::min(1.0, size / l.surface_from);
      const Vec3 normal = g * ((dot(g, direction_) > l.edge_on * size ? -1 : 1) / size);
      double diffuse = 0, specular = 0;
      for (const TrueLamp& lamp : l.lamps) {
        const double e = dot(normal, lamp.towards);
        if (e <= 0) continue;
        diffuse += lamp.intensity * e;
        specular += lamp.intensity * std::pow(std::max(0.0, dot(normal, normalize(lamp.towards - direction_))), l.power);
      }
      p.glow[i] = {1 + surface * (l.ambient + l.diffuse * diffuse - 1), surface * l.specular * specular};
    }
  }

  /// Values at a share of the piece, by the parabola through its three.
  static double between(double a, double m, double b, double f) { return a + f * (4 * m - 3 * a - b) + f * f * (2 * a - 4 * m + 2 * b); }

  void piece(Place a, Place m, Place b, int cuts) {
    bool any = false, halve = false;
    std::vector<double> shares{0, 1};
    for (size_t i = 0; i < v_.size(); ++i) {
      const double x = a.value[i], y = m.value[i], z = b.value[i];
      if (x != x || y != y || z != z) continue;  // of a hair, at an outer border
      const double bulge = std::abs(x - 2 * y + z), lo = std::min({x, y, z}) - 0.25 * bulge, hi = std::max({x, y, z}) + 0.25 * bulge;
      const auto first = std::lower_bound(v_[i].knots.begin(), v_[i].knots.end(), lo);
      if (first == v_[i].knots.end() || *first > hi) {
        any = any || v_[i].transfer->opacity_on(y, x) > 0 || v_[i].transfer->opacity_on(y, z) > 0;
        continue;
      }
      any = true;
      if (bulge > 1e-3 * std::abs(z - x)) halve = true;
      else
        for (auto k = first; k != v_[i].knots.end() && *k <= hi; ++k) {
          double f = (*k - x) / (z - x);
          for (int n = 0; n < 3; ++n) f = std::clamp(f - (between(x, y, z, f) - *k) / (z - x), 0.0, 1.0);
          shares.push_back(f);
        }
    }
    if (!any) return;
    if (halve && cuts < 24) return halves(a, m, b, cuts);
    std::sort(shares.begin(), shares.end());
    double most_depth = 0;
    for (size_t k = 0; k + 1 < shares.size(); ++k)
      for (size_t i = 0; i < v_.size(); ++i) most_depth += depth_of(i, a, m, b, shares[k], shares[k + 1]);
    if (!(most_depth > 1e-12)) return;
    bool lit = false;
    for (const TrueVolume& v : v_) lit = lit || v.light;
    if (lit) {
      light(a), light(m), light(b);
      double off = 0;
      for (size_t i = 0; i < v_.size(); ++i) {
        off = std::max(off, std::abs(m.glow[i].diffuse - 0.5 * (a.glow[i].diffuse + b.glow[i].diffuse)) +
                                std::abs(m.glow[i].specular - 0.5 * (a.glow[i].specular + b.glow[i].specular)));
        if (cuts == 0) off = std::max(off, 0.05 * std::abs(a.glow[i].diffuse - b.glow[i].diffuse));
      }
      if (cuts < 18 && sum_.pass * std::min(1.0, most_depth) * off > 1e-5) return halves(a, m, b, cuts);
    }
    for (size_t k = 0; k + 1 < shares.size(); ++k) straight(a, m, b, shares[k], shares[k + 1], lit);
  }
  void halves(const Place& a, const Place& m, const Place& b, int cuts) {
    piece(a, at(0.5 * (a.t + m.t)), m, cuts + 1);
    if (sum_.pass > 1e-7) piece(m, at(0.5 * (m.t + b.t)), b, cuts + 1);
  }

  double depth_of(size_t i, const Place& a, const Place& m, const Place& b, double f, double g) const {
    const double x = a.value[i], y = m.value[i], z = b.value[i];
    if (x != x || y != y || z != z || !(g > f)) return 0;
    const double inside = between(x, y, z, 0.5 * (f + g));
    const TrueTransfer& c = *v_[i].transfer;
    const double first = c.opacity_on(inside, between(x, y, z, f)), last = c.opacity_on(inside, between(x, y, z, g));
    return first > 0 || last > 0 ? c.mean_tau(first, last) * (g - f) * (b.t - a.t) : 0;
  }

  /// How far the colour at the middle of the share [f, g] lies beside the mean of its ends, twice.
  double color_arch(size_t i, const Place& a, const Place& m, const Place& b, double f, double g) const {
    const double x = a.value[i], y = m.value[i], z = b.value[i];
    if (x != x || y != y || z != z) return 0;
    const double inside = between(x, y, z, 0.5 * (f + g));
    const TrueTransfer& c = *v_[i].transfer;
    const Vec3 d = c.color_on(inside, between(x, y, z, f)) + c.color_on(inside, between(x, y, z, g)) - c.color_on(inside, inside) * 2;
    return std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  }

  /// The share [f, g] without a knot.
  void straight(const Place& a, const Place& m, const Place& b, double f, double g, bool lit) {
    double all = 0, halves = 0, arch = 0;
    for (size_t i = 0; i < v_.size(); ++i) {
      all += depth_of(i, a, m, b, f, g);
      arch = std::max(arch, color_arch(i, a, m, b, f, g));
      halves += depth_of(i, a, m, b, f, 0.5 * (f + g)) + depth_of(i, a, m, b, 0.5 * (f + g), g);
    }
    if (!(std::max(all, halves) > 0)) return;
    // As many parts as its depth asks for, the arch of a value that turns, and that of its colours: the one at the middle of a part is
    // wrong by a sixth of it.
    const double parts = std::max({halves / 0.02, std::sqrt(sum_.pass * std::abs(halves - all) * 1e7),
                                   std::sqrt(sum_.pass * std::min(1.0, halves) * arch * (1e6 / 6))});
    const int n = int(std::clamp(std::ceil(parts), 1.0, 400.0));
    for (int k = 0; k < n; ++k) {
      const double f0 = f + (g - f) * k / n, f1 = f + (g - f) * (k + 1) / n, middle = 0.5 * (f0 + f1);
      double depth = 0;
      Vec3 glow{0, 0, 0};
      for (size_t i = 0; i < v_.size(); ++i) {
        const double d = depth_of(i, a, m, b, f0, f1);
        if (!(d > 0)) continue;
        const double v = between(a.value[i], m.value[i], b.value[i], middle);
        Vec3 c = v_[i].transfer->color_on(v, v);
        if (lit && v_[i].light) {
          const double diffuse = between(a.glow[i].diffuse, m.glow[i].diffuse, b.glow[i].diffuse, middle),
                       specular = between(a.glow[i].specular, m.glow[i].specular, b.glow[i].specular, middle);
          c = c * diffuse + Vec3{specular, specular, specular};
        }
        depth += d, glow += c * d;
      }
      if (!(depth > 0)) continue;
      const double taken = sum_.pass * -std::expm1(-depth);
      sum_.color += glow * (taken / depth);
      sum_.pass *= std::exp(-depth);
    }
  }

  std::vector<TrueVolume> v_;
  Vec3 direction_;
  int pieces_;
  TrueSum sum_;
};

}  // namespace sg::test
