// SPDX-License-Identifier: Apache-2.0
#include "color/cie.h"

#include <algorithm>
#include <numbers>

namespace sg {
namespace {

constexpr double epsilon = 216.0 / 24389.0;
constexpr double kappa = 24389.0 / 27.0;
using std::numbers::pi;
constexpr double degree = pi / 180;

constexpr Vec3 xyz_of(double x, double y) { return {x / y, 1, (1 - x - y) / y}; }
constexpr Vec3 white{0.95047, 1, 1.08883};  // D65, 2 degrees (ASTM E308)

/// Columns are the primaries' XYZ scaled so that R = G = B = 1 gives D65.
struct Matrices {
  Mat3 to_xyz, to_rgb;
  Matrices() {
    const Vec3 r = xyz_of(0.64, 0.33), g = xyz_of(0.30, 0.60), b = xyz_of(0.15, 0.06);
    Mat3 p;
    for (int i = 0; i < 3; ++i) p.m[i][0] = r[i], p.m[i][1] = g[i], p.m[i][2] = b[i];
    const Vec3 s = inverse(p) * white;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) to_xyz.m[i][j] = p.m[i][j] * s[j];
    to_rgb = inverse(to_xyz);
  }
};

const Matrices& matrices() {
  static const Matrices m;
  return m;
}

double lab_f(double t) { return t > epsilon ? std::cbrt(t) : (kappa * t + 16) / 116; }
double lab_f_inverse(double f) {
  const double cube = f * f * f;
  return cube > epsilon ? cube : (116 * f - 16) / kappa;
}

double seventh(double c) {
  const double c2 = c * c;
  return c2 * c2 * c2 * c;
}

double hue_degrees(double a, double b) {
  if (a == 0 && b == 0) return 0;
  const double h = std::atan2(b, a) / degree;
  return h < 0 ? h + 360 : h;
}

}  // namespace

double srgb_to_linear(double e) {
  if (e < 0) return -srgb_to_linear(-e);
  return e <= 0.04045 ? e / 12.92 : std::pow((e + 0.055) / 1.055, 2.4);
}

double linear_to_srgb(double l) {
  if (l < 0) return -linear_to_srgb(-l);
  return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055;
}

Vec3 srgb_to_linear(Vec3 e) { return {srgb_to_linear(e.x), srgb_to_linear(e.y), srgb_to_linear(e.z)}; }
Vec4f srgb_to_linear(Vec4f e) {
  return {float(srgb_to_linear(double(e.x))), float(srgb_to_linear(double(e.y))), float(srgb_to_linear(double(e.z))), e.w};
}
Vec3 linear_to_srgb(Vec3 l) { return {linear_to_srgb(l.x), linear_to_srgb(l.y), linear_to_srgb(l.z)}; }

Vec3 linear_to_xyz(Vec3 linear) { return matrices().to_xyz * linear; }
Vec3 xyz_to_linear(Vec3 xyz) { return matrices().to_rgb * xyz; }

Vec3 xyz_to_lab(Vec3 xyz) {
  const double fx = lab_f(xyz.x / white.x), fy = lab_f(xyz.y / white.y), fz = lab_f(xyz.z / white.z);
  return {116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)};
}

Vec3 lab_to_xyz(Vec3 lab) {
  const double fy = (lab.x + 16) / 116;
  return {white.x * lab_f_inverse(fy + lab.y / 500), white.y * lab_f_inverse(fy), white.z * lab_f_inverse(fy - lab.z / 200)};
}

Vec3 srgb_to_lab(Vec3 encoded) { return xyz_to_lab(linear_to_xyz(srgb_to_linear(encoded))); }
Vec3 lab_to_srgb(Vec3 lab) { return linear_to_srgb(xyz_to_linear(lab_to_xyz(lab))); }

bool in_gamut(Vec3 c, double slack) {
  for (int i = 0; i < 3; ++i)
    if (!(c[i] >= -slack && c[i] <= 1 + slack)) return false;
  return true;
}

double ciede2000(Vec3 p, Vec3 q) {
  const double seven25 = seventh(25);
  // a' stretches the neutral axis; it depends on the mean chroma of the pair.
  const double c_mean = 0.5 * (std::hypot(p.y, p.z) + std::hypot(q.y, q.z));
  const double g = 0.5 * (1 - std::sqrt(seventh(c_mean) / (seventh(c_mean) + seven25)));
  const double a1 = (1 + g) * p.y, a2 = (1 + g) * q.y;
  const double c1 = std::hypot(a1, p.z), c2 = std::hypot(a2, q.z);
  const double h1 = hue_degrees(a1, p.z), h2 = hue_degrees(a2, q.z);

  // Hue difference and mean the short way round; with a grey partner the other's hue counts.
  double dh = 0, h_mean = h1 + h2;
  if (c1 * c2 != 0) {
    dh = h2 - h1;
    if (dh > 180) dh -= 360;
    else if (dh < -180) dh += 360;
    if (std::abs(h1 - h2) <= 180) h_mean *= 0.5;
    else h_mean = 0.5 * (h_mean < 360 ? h_mean + 360 : h_mean - 360);
  }
  const double dL = q.x - p.x, dC = c2 - c1, dH = 2 * std::sqrt(c1 * c2) * std::sin(0.5 * dh * degree);
  const double L = 0.5 * (p.x + q.x), C = 0.5 * (c1 + c2);

  const double T = 1 - 0.17 * std::cos((h_mean - 30) * degree) + 0.24 * std::cos(2 * h_mean * degree) +
                   0.32 * std::cos((3 * h_mean + 6) * degree) - 0.20 * std::cos((4 * h_mean - 63) * degree);
  const double turn = (h_mean - 275) / 25;
  const double theta = 30 * std::exp(-turn * turn);
  const double l50 = (L - 50) * (L - 50);
  const double SL = 1 + 0.015 * l50 / std::sqrt(20 + l50), SC = 1 + 0.045 * C, SH = 1 + 0.015 * C * T;
  const double RT = -2 * std::sqrt(seventh(C) / (seventh(C) + seven25)) * std::sin(2 * theta * degree);
  const double l = dL / SL, c = dC / SC, h = dH / SH;
  return std::sqrt(std::max(0.0, l * l + c * c + h * h + RT * c * h));
}

}  // namespace sg
