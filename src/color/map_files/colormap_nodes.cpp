// SPDX-License-Identifier: Apache-2.0
#include "color/map_files/colormap_nodes.h"

#include <algorithm>
#include <numbers>

#include "color/cie.h"
#include "color/msh.h"

namespace sg {

namespace {

constexpr double fine = 1024;  ///< samples of a path that is not a straight line in RGB

Vec3 msh_between(Vec3 lab1, Vec3 lab2, double t) {
  Msh a = lab_to_msh(lab1), b = lab_to_msh(lab2);
  double turn = std::abs(a.h - b.h);
  if (turn > std::numbers::pi) turn = 2 * std::numbers::pi - turn;
  if (a.s > 0.05 && b.s > 0.05 && turn > std::numbers::pi / 3) {  // two saturated colours meet in white
    const double m = std::max({a.m, b.m, 88.0});
    if (t < 0.5) b = {m, 0, 0}, t = 2 * t;
    else a = {m, 0, 0}, t = 2 * t - 1;
  }
  if (a.s < 0.05 && b.s > 0.05) a.h = adjusted_hue(b, a.m);
  else if (b.s < 0.05 && a.s > 0.05) b.h = adjusted_hue(a, b.m);
  return msh_to_lab({std::lerp(a.m, b.m, t), std::lerp(a.s, b.s, t), std::lerp(a.h, b.h, t)});
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

Vec3f rgb_to_hsv(Vec3f color) {
  const Vec3 c(color);
  const double hi = std::max({c.x, c.y, c.z}), lo = std::min({c.x, c.y, c.z}), d = hi - lo;
  if (d <= 0) return {0, 0, float(hi)};
  double h = hi == c.x ? (c.y - c.z) / d : hi == c.y ? 2 + (c.z - c.x) / d : 4 + (c.x - c.y) / d;
  if (h < 0) h += 6;
  return {float(60 * h), float(d / hi), float(hi)};
}

Vec3f between(Vec3f a, Vec3f b, double t, NodeSpace space) {
  if (t <= 0) return a;
  if (t >= 1) return b;
  switch (space) {
    case NodeSpace::rgb:
    case NodeSpace::hue: break;
    case NodeSpace::hsv: {
      const Vec3 c = lerp(Vec3(rgb_to_hsv(a)), Vec3(rgb_to_hsv(b)), t);
      return hsv_to_rgb(c.x, c.y, c.z);
    }
    case NodeSpace::lab: return clamped(lab_to_srgb(lerp(srgb_to_lab(Vec3(a)), srgb_to_lab(Vec3(b)), t)));
    case NodeSpace::diverging: return clamped(lab_to_srgb(msh_between(srgb_to_lab(Vec3(a)), srgb_to_lab(Vec3(b)), t)));
  }
  return lerp(a, b, float(t));
}

void set_nodes(Colormap& map, std::span<const ColorNode> given, NodeSpace space) {
  map.colors.clear(), map.positions.clear();
  // Of more than two nodes at one place only the outer ones are seen.
  std::vector<ColorNode> nodes;
  for (const ColorNode& n : given) {
    const size_t k = nodes.size();
    if (k > 0 && nodes[k - 1].position == n.position && nodes[k - 1].color == n.color) continue;
    if (k > 1 && nodes[k - 1].position == n.position && nodes[k - 2].position == n.position) nodes.pop_back();
    nodes.push_back(n);
  }
  if (nodes.empty()) return;
  const double lo = nodes.front().position, width = nodes.back().position - lo;
  if (!(width > 0)) {
    for (const ColorNode& n : nodes) map.colors.push_back(n.color);
    if (map.colors.size() == 1) map.colors.push_back(map.colors[0]);
    return;
  }
  const auto add = [&](double position, Vec3f c) {
    map.positions.push_back((position - lo) / width);
    map.colors.push_back(space == NodeSpace::hue ? hsv_to_rgb(c.x, c.y, c.z) : c);
  };
  for (size_t k = 0; k < nodes.size(); ++k) {
    add(nodes[k].position, nodes[k].color);
    if (space == NodeSpace::rgb || k + 1 == nodes.size()) continue;
    const ColorNode &from = nodes[k], &to = nodes[k + 1];
    const double length = to.position - from.position;
    const int pieces = length > 0 ? int(std::clamp(std::ceil(fine * length / width), 16.0, fine)) : 1;
    for (int i = 1; i < pieces; ++i) {
      const double f = double(i) / pieces;
      add(from.position + f * length, between(from.color, to.color, f, space));
    }
  }
  map.positions.back() = 1;
  // Evenly spaced positions (up to rounding) need not be stored.
  const size_t n = map.positions.size();
  for (size_t i = 0; i < n; ++i)
    if (std::abs(map.positions[i] * double(n - 1) - double(i)) > 1e-9) return;
  map.positions.clear();
}

MapKind kind_of_colors(const Colormap& map) {
  if (map.colors.size() < 2) return MapKind::sequential;
  constexpr int n = 65;
  constexpr double slack = 2;  ///< L* that an 8-bit table may go the wrong way
  double l[n];
  for (int i = 0; i < n; ++i) l[i] = srgb_to_lab(Vec3(map.at(double(i) / (n - 1)))).x;
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
  if (ciede2000(srgb_to_lab(Vec3(map.colors.front())), srgb_to_lab(Vec3(map.colors.back()))) < 3) {
    // Once up and once down, begun at the darkest colour; the last sample is the first.
    std::rotate(l, std::min_element(l, l + n - 1), l + n - 1);
    l[n - 1] = l[0];
    const int top = int(std::max_element(l, l + n) - l);
    return runs(0, top, 1) && runs(top, n - 1, -1) ? MapKind::cyclic : MapKind::unsafe;
  }
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
