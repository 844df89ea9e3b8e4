// SPDX-License-Identifier: Apache-2.0
#include "render/volume/medium/cubic.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sg::volume {

double bernstein(const float b[4], double f) {
  const double g = 1 - f;
  const double b01 = g * double(b[0]) + f * double(b[1]), b12 = g * double(b[1]) + f * double(b[2]),
               b23 = g * double(b[2]) + f * double(b[3]);
  return g * (g * b01 + f * b12) + f * (g * b12 + f * b23);
}

int turns(const float b[4], double f[2]) {
  // The derivative/3: p (1-f)^2 + 2 q f (1-f) + r f^2.
  const double p = double(b[1]) - double(b[0]), q = double(b[2]) - double(b[1]), r = double(b[3]) - double(b[2]);
  const double a = p - 2 * q + r, h = q - p, d = h * h - a * p;  // a f^2 + 2 h f + p
  int n = 0;
  const auto add = [&](double x) {
    if (x > 0 && x < 1) f[n++] = x;
  };
  if (!(d >= 0)) return 0;
  const double w = -(h + std::copysign(std::sqrt(d), h));
  if (w != 0) add(p / w);
  if (a != 0 && d > 0) add(w / a);
  if (n == 2 && f[0] > f[1]) std::swap(f[0], f[1]);
  return n;
}

namespace {

/// The zero of a monotone part: false position that keeps it enclosed (Illinois).
double root_between(const float b[4], double level, double lo, double hi, double at_lo, double at_hi) {
  int side = 0;
  for (int i = 0; i < 60; ++i) {
    const double m = (at_lo * hi - at_hi * lo) / (at_lo - at_hi), at = bernstein(b, m) - level;
    if (at == 0 || !(m > lo && m < hi) || hi - lo < 1e-14) return std::clamp(m, lo, hi);
    if ((at > 0) == (at_hi > 0)) {
      hi = m, at_hi = at;
      if (side == -1) at_lo *= 0.5;
      side = -1;
    } else {
      lo = m, at_lo = at;
      if (side == 1) at_hi *= 0.5;
      side = 1;
    }
  }
  return 0.5 * (lo + hi);
}

}  // namespace

int crossings(const float b[4], float level, double f[3]) {
  if (level < std::min({b[0], b[1], b[2], b[3]}) || level > std::max({b[0], b[1], b[2], b[3]})) return 0;
  double ends[4] = {0, 1, 1, 1}, turn[2];
  const int inner = turns(b, turn);
  for (int i = 0; i < inner; ++i) ends[i + 1] = turn[i];
  ends[inner + 1] = 1;
  int n = 0;
  for (int i = 0; i <= inner; ++i) {
    const double lo = bernstein(b, ends[i]) - double(level), hi = bernstein(b, ends[i + 1]) - double(level);
    if (lo == 0 && hi == 0) continue;
    double at;
    if (lo == 0) at = ends[i];
    else if (hi == 0) at = ends[i + 1];
    else if ((lo > 0) != (hi > 0)) at = root_between(b, double(level), ends[i], ends[i + 1], lo, hi);
    else continue;
    if (n == 0 || at > f[n - 1]) f[n++] = at;
    if (n == 3) break;
  }
  return n;
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

}  // namespace sg::volume
