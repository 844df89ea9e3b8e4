// SPDX-License-Identifier: Apache-2.0
#include "color/colormap_nodes.h"

#include <numbers>

#include "color/cie.h"

namespace sg {

namespace {

constexpr size_t fine = 1025;

struct Hsv {
  double h, s, v;  ///< hue in turns
};

Hsv rgb_to_hsv(Vec3f c) {
  const double hi = std::max({c.x, c.y, c.z}), lo = std::min({c.x, c.y, c.z}), d = hi - lo;
  if (d <= 0) return {0, 0, hi};
  double h = hi == c.x ? (c.y - c.z) / d : hi == c.y ? 2 + (c.z - c.x) / d : 4 + (c.x - c.y) / d;
  if (h < 0) h += 6;
  return {h / 6, d / hi, hi};
}

struct Msh {
  double m, s, h;
};

Msh lab_to_msh(Vec3 lab) {
  const double m = length(lab);
  const double s = m > 1e-3 ? std::acos(std::clamp(lab.x / m, -1.0, 1.0)) : 0;
  return {m, s, s > 1e-3 ? std::atan2(lab.z, lab.y) : 0};
}

// The hue that a grey takes so that the path to a saturated colour does not bend.
double spun_hue(const Msh& saturated, double m) {
  if (saturated.m >= m - 0.1) return saturated.h;
  const double spin = saturated.s * std::sqrt(m * m - saturated.m * saturated.m) / (saturated.m * std::sin(saturated.s));
  return saturated.h > -std::numbers::pi / 3 ? saturated.h + spin : saturated.h - spin;
}

Vec3 msh_between(Vec3 lab1, Vec3 lab2, double t) {
  Msh a = lab_to_msh(lab1), b = lab_to_msh(lab2);
  double turn = std::abs(a.h - b.h);
  if (turn > std::numbers::pi) turn = 2 * std::numbers::pi - turn;
  if (a.s > 0.05 && b.s > 0.05 && turn > std::numbers::pi / 3) {  // two saturated colours meet in white
    const double m = std::max({a.m, b.m, 88.0});
    if (t < 0.5) b = {m, 0, 0}, t = 2 * t;
    else a = {m, 0, 0}, t = 2 * t - 1;
  }
  if (a.s < 0.05 && b.s > 0.05) a.h = spun_hue(b, a.m);
  else if (b.s < 0.05 && a.s > 0.05) b.h = spun_hue(a, b.m);
  const double m = std::lerp(a.m, b.m, t), s = std::lerp(a.s, b.s, t), h = std::lerp(a.h, b.h, t);
  return {m * std::cos(s), m * std::sin(s) * std::cos(h), m * std::sin(s) * std::sin(h)};
}

Vec3f clamped(Vec3 c) { return {float(std::clamp(c.x, 0.0, 1.0)), float(std::clamp(c.y, 0.0, 1.0)), float(std::clamp(c.z, 0.0, 1.0))}; }

}  // namespace

Vec3f hsv_to_rgb(double hue, double s, double v) {
  const double h = (hue / 360 - std::floor(hue / 360)) * 6;
  auto channel = [&](double shift) {
    const double k = std::fmod(shift + h, 6.0);
    return v - v * s * std::clamp(std::min(k, 4 - k), 0.0, 1.0);
  };
  return clamped({channel(5), channel(3), channel(1)});
}

Vec3f between(Vec3f a, Vec3f b, double t, NodeSpace space) {
  if (t <= 0) return a;
  if (t >= 1) return b;
  switch (space) {
    case NodeSpace::rgb: break;
    case NodeSpace::hsv: {
      const Hsv p = rgb_to_hsv(a), q = rgb_to_hsv(b);
      return hsv_to_rgb(360 * std::lerp(p.h, q.h, t), std::lerp(p.s, q.s, t), std::lerp(p.v, q.v, t));
    }
    case NodeSpace::lab: return clamped(lab_to_srgb(lerp(srgb_to_lab(Vec3(a)), srgb_to_lab(Vec3(b)), t)));
    case NodeSpace::diverging: return clamped(lab_to_srgb(msh_between(srgb_to_lab(Vec3(a)), srgb_to_lab(Vec3(b)), t)));
  }
  return lerp(a, b, float(t));
}

std::vector<Vec3f> sample_nodes(std::span<const ColorNode> nodes, NodeSpace space) {
  std::vector<Vec3f> r;
  if (nodes.empty()) return r;
  const double lo = nodes.front().position, width = nodes.back().position - lo;
  bool even = space == NodeSpace::rgb && nodes.size() > 1;
  const double step = width / double(nodes.size() - 1);
  for (size_t i = 0; i < nodes.size() && even; ++i) even = std::abs(nodes[i].position - lo - double(i) * step) < 0.02 * step;
  if (even || !(width > 0)) {
    for (const ColorNode& n : nodes) r.push_back(n.color);
    if (r.size() == 1) r.push_back(r[0]);
    return r;
  }
  const size_t n = std::max(fine, 4 * nodes.size() + 1);
  size_t k = 0;
  for (size_t i = 0; i < n; ++i) {
    const double x = lo + width * double(i) / double(n - 1);
    while (k + 2 < nodes.size() && nodes[k + 1].position <= x) ++k;
    const double d = nodes[k + 1].position - nodes[k].position;
    r.push_back(between(nodes[k].color, nodes[k + 1].color, d > 0 ? (x - nodes[k].position) / d : 1, space));
  }
  r.back() = nodes.back().color;
  return r;
}

MapKind kind_of_colors(std::span<const Vec3f> colors) {
  if (colors.size() < 2) return MapKind::sequential;
  constexpr int n = 65;
  constexpr double slack = 2;  ///< L* that an 8-bit table may go the wrong way
  double l[n];
  for (int i = 0; i < n; ++i) {
    const double x = double(i) / (n - 1) * double(colors.size() - 1);
    const size_t k = std::min(size_t(x), colors.size() - 2);
    l[i] = srgb_to_lab(Vec3(lerp(colors[k], colors[k + 1], float(x - double(k))))).x;
  }
  // Whether l goes up (sign 1) or down (-1) between two samples, but for the slack.
  auto runs = [&](int begin, int end, double sign) {
    double most = -1e9;
    for (int i = begin; i <= end; ++i) {
      if (sign * l[i] < most - slack) return false;
      most = std::max(most, sign * l[i]);
    }
    return true;
  };
  if (runs(0, n - 1, 1) || runs(0, n - 1, -1)) return MapKind::sequential;
  if (ciede2000(srgb_to_lab(Vec3(colors.front())), srgb_to_lab(Vec3(colors.back()))) < 3) return MapKind::cyclic;
  for (const double sign : {1.0, -1.0}) {
    int top = 0;
    for (int i = 1; i < n; ++i)
      if (sign * l[i] > sign * l[top]) top = i;
    if (top > n / 3 && top < n - n / 3 && std::abs(l[0] - l[n - 1]) < 20 && runs(0, top, sign) && runs(top, n - 1, -sign))
      return MapKind::diverging;
  }
  return MapKind::unsafe;
}

}  // namespace sg
