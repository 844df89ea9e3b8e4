// SPDX-License-Identifier: Apache-2.0
#include "color/map_construction.h"

#include <algorithm>
#include <numbers>

#include "color/cie.h"
#include "color/msh.h"

namespace sg {
namespace {

using std::numbers::pi;

Vec3 lch_to_lab(double l, double c, double h) { return {l, c * std::cos(h * pi / 180), c * std::sin(h * pi / 180)}; }

Vec3f to_float(Vec3 srgb) {
  return {float(std::clamp(srgb.x, 0.0, 1.0)), float(std::clamp(srgb.y, 0.0, 1.0)), float(std::clamp(srgb.z, 0.0, 1.0))};
}

/// Monotone cubic through equally spaced values (slopes after Steffen 1990): no overshoot between controls.
double monotone_cubic(std::span<const double> y, double u) {
  const int n = int(y.size());
  if (n == 1) return y[0];
  const double x = std::clamp(u, 0.0, 1.0) * (n - 1);
  const int i = std::min(int(x), n - 2);
  const auto secant = [&](int k) { return y[size_t(k + 1)] - y[size_t(k)]; };
  const auto slope = [&](int k) {
    if (k == 0) return secant(0);
    if (k == n - 1) return secant(n - 2);
    const double a = secant(k - 1), b = secant(k);
    if (a * b <= 0) return 0.0;
    return std::copysign(1.0, a) * 2 * std::min({std::abs(a), std::abs(b), 0.25 * std::abs(a + b)});
  };
  const double t = x - i, m0 = slope(i), m1 = slope(i + 1), d = secant(i);
  return y[size_t(i)] + t * (m0 + t * ((3 * d - 2 * m0 - m1) + t * (m0 + m1 - 2 * d)));
}

/// Parameters u_i from 0 to 1 for which color(i, u_i) has equal CIEDE2000 steps: each interval is scaled by the ratio of the
/// mean step to its own, again and again.
template <class LabAt>
std::vector<double> even_steps(int n, LabAt&& lab_at) {
  std::vector<double> u(static_cast<size_t>(n)), step(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) u[size_t(i)] = double(i) / (n - 1);
  for (int round = 0; round < 24; ++round) {
    double total = 0;
    Vec3 last = lab_at(0, 0.0);
    for (int i = 1; i < n; ++i) {
      const Vec3 next = lab_at(i, u[size_t(i)]);
      total += step[size_t(i)] = ciede2000(last, next);
      last = next;
    }
    const double mean = total / (n - 1);
    double sum = 0;
    std::vector<double> width(static_cast<size_t>(n));
    for (int i = 1; i < n; ++i) {
      const double ratio = step[size_t(i)] > 0 ? mean / step[size_t(i)] : 1;
      sum += width[size_t(i)] = (u[size_t(i)] - u[size_t(i - 1)]) * std::clamp(ratio, 0.5, 2.0);
    }
    for (int i = 1; i < n; ++i) u[size_t(i)] = u[size_t(i - 1)] + width[size_t(i)] / sum;
    u[size_t(n - 1)] = 1;
  }
  return u;
}

}  // namespace

std::vector<Vec3f> sequential_path(double from, double to, std::span<const HueChroma> controls, int n) {
  std::vector<double> hue, chroma;
  for (const HueChroma& c : controls) hue.push_back(c.hue), chroma.push_back(c.chroma);
  const auto lab_at = [&](int i, double u) {
    return lch_to_lab(from + (to - from) * i / (n - 1), monotone_cubic(chroma, u), monotone_cubic(hue, u));
  };
  const std::vector<double> u = even_steps(n, lab_at);
  std::vector<Vec3f> colors;
  for (int i = 0; i < n; ++i) colors.push_back(to_float(lab_to_srgb(lab_at(i, u[size_t(i)]))));
  return colors;
}

std::vector<Vec3f> diverging_path(double end_lightness, double middle_lightness, double hue1, double hue2, double chroma, int n) {
  const double rounding = 0.08;
  std::vector<Vec3f> colors;
  for (int i = 0; i < n; ++i) {
    const double x = 2.0 * i / (n - 1) - 1;
    // |x| with a rounded tip, 0 at the middle and 1 at the ends.
    const double d = (std::sqrt(x * x + rounding * rounding) - rounding) / (std::sqrt(1 + rounding * rounding) - rounding);
    const double c = chroma * std::sin(std::min(1.0, 1.35 * d) * pi / 2);
    colors.push_back(to_float(lab_to_srgb(lch_to_lab(middle_lightness + (end_lightness - middle_lightness) * d, c, x < 0 ? hue1 : hue2))));
  }
  return colors;
}

std::vector<Vec3f> moreland_diverging(Vec3 srgb1, Vec3 srgb2, int n) {
  const Msh end1 = lab_to_msh(srgb_to_lab(srgb1)), end2 = lab_to_msh(srgb_to_lab(srgb2));
  const double middle = std::max({end1.m, end2.m, 88.0});
  std::vector<Vec3f> colors;
  for (int i = 0; i < n; ++i) {
    const double x = double(i) / (n - 1);
    const Msh& end = x < 0.5 ? end1 : end2;
    const double t = std::abs(2 * x - 1);  // 0 at the middle
    const double h = adjusted_hue(end, middle);
    const Msh c{middle + (end.m - middle) * t, end.s * t, h + (end.h - h) * t};
    colors.push_back(to_float(t == 1 ? (i == 0 ? srgb1 : srgb2) : lab_to_srgb(msh_to_lab(c))));
  }
  return colors;
}

std::vector<Vec3f> hue_circle(int n) {
  // Chroma and lightness follow the gamut a little, so that no hue is muddy: controls every 45 degrees from red.
  static constexpr double chroma[] = {55, 55, 52, 45, 36, 38, 46, 53, 55};
  static constexpr double lightness[] = {62, 66, 70, 70, 68, 66, 62, 60, 62};
  const auto lab_at = [&](int, double u) { return lch_to_lab(monotone_cubic(lightness, u), monotone_cubic(chroma, u), 20 + 360 * u); };
  const std::vector<double> u = even_steps(n, lab_at);
  std::vector<Vec3f> colors;
  for (int i = 0; i < n; ++i) colors.push_back(to_float(lab_to_srgb(lab_at(i, u[size_t(i)]))));
  colors.back() = colors.front();
  return colors;
}

std::vector<Vec3f> cubehelix(double start, double rotations, double saturation, double gamma, int n) {
  std::vector<Vec3f> colors;
  for (int i = 0; i < n; ++i) {
    const double x = double(i) / (n - 1), grey = std::pow(x, gamma);
    const double angle = 2 * pi * (start / 3 + rotations * x), amplitude = saturation * grey * (1 - grey) / 2;
    const double c = amplitude * std::cos(angle), s = amplitude * std::sin(angle);
    colors.push_back(to_float({grey - 0.14861 * c + 1.78277 * s, grey - 0.29227 * c - 0.90649 * s, grey + 1.97294 * c}));
  }
  return colors;
}

}  // namespace sg
