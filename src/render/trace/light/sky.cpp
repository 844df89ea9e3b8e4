// SPDX-License-Identifier: Apache-2.0
#include "render/trace/light/sky.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/parallel.h"

namespace sg::trace {

namespace {

constexpr double exact_pi = std::numbers::pi;
constexpr int mu_cells = 256, r_cells = 64;        // of the table of sunlight
constexpr int often_cells = 32;                    // of that of light scattered often, along each axis
constexpr int table_steps = 200, sphere_side = 8;  // of its integrals
constexpr double eye_height = 200;                 // metres above the ground

Vec3 times(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
Vec3 exp_of_minus(Vec3 v) { return {std::exp(-v.x), std::exp(-v.y), std::exp(-v.z)}; }

/// Bilinear, at places in [0, 1] of the first and the last point.
Vec3 look_up(const std::vector<Vec3>& table, int width, double x, double y) {
  const int height = int(table.size()) / width;
  const double fx = std::clamp(x, 0.0, 1.0) * (width - 1), fy = std::clamp(y, 0.0, 1.0) * (height - 1);
  const int ix = std::min(int(fx), width - 2), iy = std::min(int(fy), height - 2);
  const double wx = fx - ix, wy = fy - iy;
  const Vec3* p = &table[size_t(iy) * size_t(width) + size_t(ix)];
  const Vec3* q = p + width;
  return (p[0] * (1 - wx) + p[1] * wx) * (1 - wy) + (q[0] * (1 - wx) + q[1] * wx) * wy;
}

double rayleigh_phase(double c) { return 3 / (16 * exact_pi) * (1 + c * c); }
double mie_phase(double c, double g) {
  const double d = 1 + g * g - 2 * g * c;
  return (1 - g * g) / (4 * exact_pi * d * std::sqrt(d));
}

/// Of a level surface, or one that faces `normal`.
Vec3 irradiance(const std::vector<Vec3f>& pixels, int width, int height, Vec3 normal) {
  Vec3 sum;
  for (int y = 0; y < height; ++y) {
    const double top = std::cos(exact_pi * y / height), bottom = std::cos(exact_pi * (y + 1) / height), z = (top + bottom) / 2;
    const double sine = std::sqrt(1 - z * z), cell = 2 * exact_pi / width * (top - bottom);
    for (int x = 0; x < width; ++x) {
      const double a = exact_pi - 2 * exact_pi * (x + 0.5) / width;
      const double cosine = dot(normal, Vec3{std::cos(a) * sine, std::sin(a) * sine, z});
      if (cosine > 0) sum += Vec3(pixels[size_t(y) * size_t(width) + size_t(x)]) * (cosine * cell);
    }
  }
  return sum;
}

}  // namespace

SkyModel::SkyModel(const Atmosphere& air, int steps) : air_(air), steps_(steps) {
  fill_sunlight();
  fill_scattered();
}

// Rows by the distance to the horizon, columns by the length of the way to the top between its least (straight up) and its greatest (past
// the horizon), as Bruneton and Neyret (2008) place them: dense where light changes fast.
void SkyModel::fill_sunlight() {
  sunlight_.resize(size_t(mu_cells) * r_cells);
  const double edge = std::sqrt((air_.top - air_.ground) * (air_.top + air_.ground));
  parallel_for(size_t(r_cells), 1, [&](size_t begin, size_t end) {
    for (size_t j = begin; j < end; ++j) {
      const double rho = edge * double(j) / (r_cells - 1), r = std::sqrt(rho * rho + air_.ground * air_.ground);
      for (size_t i = 0; i < size_t(mu_cells); ++i) {
        const double least = air_.top - r, most = rho + edge, d = least + (most - least) * double(i) / (mu_cells - 1);
        const double mu = d > 0 ? std::clamp((edge * edge - rho * rho - d * d) / (2 * r * d), -1.0, 1.0) : 1;
        sunlight_[j * mu_cells + i] = exp_of_minus(optical_depth(air_, r, mu, d, table_steps));
      }
    }
  });
}

Vec3 SkyModel::sunlight(double r, double mu) const {
  const double edge2 = (air_.top - air_.ground) * (air_.top + air_.ground), edge = std::sqrt(edge2);
  const double rho2 = std::max(0.0, (r - air_.ground) * (r + air_.ground)), rho = std::sqrt(rho2);
  const AirPath path = air_path(air_, r, mu);
  if (path.meets_ground) return {};
  const double least = air_.top - r, most = rho + edge;
  const double x = most > least ? (path.length - least) / (most - least) : 0;
  return look_up(sunlight_, mu_cells, x, rho / edge);
}

// What is scattered twice comes from all sides about alike, and each further time the same share f of it: 1 + f + f^2 + ...
void SkyModel::fill_scattered() {
  often_.resize(size_t(often_cells) * often_cells);
  constexpr int steps = 24;
  parallel_for(often_.size(), 4, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const double mu = 2 * double(i % often_cells) / (often_cells - 1) - 1;
      const double r = air_.ground + std::max(1.0, (air_.top - air_.ground - 1) * double(i / often_cells) / (often_cells - 1));
      const Vec3 sun{std::sqrt(std::max(0.0, 1 - mu * mu)), 0, mu};
      Vec3 second, share;
      for (int v = 0; v < sphere_side; ++v)
        for (int u = 0; u < sphere_side; ++u) {
          const double z = 1 - 2 * (v + 0.5) / sphere_side, s = std::sqrt(1 - z * z), a = 2 * exact_pi * (u + 0.5) / sphere_side;
          const Vec3 d{s * std::cos(a), s * std::sin(a), z};
          const AirPath path = air_path(air_, r, z);
          if (!(path.length > 0)) continue;
          Vec3 passed{1, 1, 1};
          for (int k = 0; k < steps; ++k) {
            const double from = double(k) / steps, to = double(k + 1) / steps, dt = path.length * (to * to - from * from);
            const Vec3 p = Vec3{0, 0, r} + d * (path.length * (from * from + to * to) / 2);
            const double radius = length(p);
            const AirAt at = air_at(air_, radius - air_.ground);
            const Vec3 scatters = at.rayleigh + at.mie, step = exp_of_minus(at.extinction * dt);
            Vec3 within;  // of the step: the integral of what is left of it
            for (int c = 0; c < 3; ++c) within[c] = at.extinction[c] > 0 ? (1 - step[c]) / at.extinction[c] : dt;
            const Vec3 lit = times(passed, times(scatters, within));
            share += lit;
            second += times(lit, sunlight(radius, dot(p, sun) / radius)) / (4 * exact_pi);
            passed = times(passed, step);
          }
          if (path.meets_ground) {
            const Vec3 at = normalize(Vec3{0, 0, r} + d * path.length);
            const double cosine = dot(at, sun);
            if (cosine > 0) second += times(passed, sunlight(air_.ground, cosine)) * (cosine * air_.albedo / exact_pi);
          }
        }
      constexpr double directions = sphere_side * sphere_side;
      second = second / directions, share = share / directions;
      for (int c = 0; c < 3; ++c) often_[i][c] = second[c] / (1 - share[c]);
    }
  });
}

Vec3 SkyModel::scattered_often(double r, double mu) const {
  return look_up(often_, often_cells, (mu + 1) / 2, (r - air_.ground) / (air_.top - air_.ground));
}

// The steps of a line of sight are cut where it enters or leaves the shadow of the ground, so that the shadow's edge makes no bands.
Vec3 SkyModel::along(double r, Vec3 direction, Vec3 sun, double length, bool often, Vec3& passed) const {
  const Vec3 eye{0, 0, r};
  // Behind the ground, within a cylinder about the axis towards the sun: a t^2 + 2 b t + c < 0.
  const Vec3 e = eye - sun * dot(eye, sun), d = direction - sun * dot(direction, sun);
  const double a = dot(d, d), b = dot(e, d), c = dot(e, e) - air_.ground * air_.ground;
  std::array<double, 4> ends{0, length, length, length};
  size_t count = 1;
  if (const double root = b * b - a * c; root > 0 && a > 0)
    for (const double t : {(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a})
      if (t > 0 && t < length) ends[count++] = t;
  ends[count] = length;
  const double cosine = dot(direction, sun), by_rayleigh = rayleigh_phase(cosine), by_mie = mie_phase(cosine, air_.mie_g);
  Vec3 seen;
  for (size_t part = 0; part < count; ++part) {
    const double from = std::sqrt(ends[part] / length), to = std::sqrt(ends[part + 1] / length);
    const int steps = std::max(4, int(std::ceil(steps_ * (to - from))));
    for (int k = 0; k < steps; ++k) {
      const double s0 = from + (to - from) * k / steps, s1 = from + (to - from) * (k + 1) / steps;
      const double dt = length * (s1 * s1 - s0 * s0);
      const Vec3 p = eye + direction * (length * (s0 * s0 + s1 * s1) / 2);
      const double radius = sg::length(p), mu = dot(p, sun) / radius;
      const AirAt at = air_at(air_, radius - air_.ground);
      Vec3 source = times(at.rayleigh * by_rayleigh + at.mie * by_mie, sunlight(radius, mu));
      if (often) source += times(at.rayleigh + at.mie, scattered_often(radius, mu));
      const Vec3 step = exp_of_minus(at.extinction * dt);
      for (int i = 0; i < 3; ++i) seen[i] += passed[i] * source[i] * (at.extinction[i] > 0 ? (1 - step[i]) / at.extinction[i] : dt);
      passed = times(passed, step);
    }
  }
  return seen;
}

Vec3 SkyModel::radiance(double r, Vec3 direction, Vec3 sun, Vec3 sky, bool often) const {
  const AirPath path = air_path(air_, r, direction.z);
  if (!(path.length > 0)) return {};
  Vec3 passed{1, 1, 1};
  Vec3 seen = along(r, direction, sun, path.length, often, passed);
  if (!path.meets_ground) return seen;
  const Vec3 at = normalize(Vec3{0, 0, r} + direction * path.length);
  const double mu = dot(at, sun);
  Vec3 light = sky;
  if (mu > 0) light += sunlight(air_.ground, mu) * mu;
  return seen + times(passed, light) * (air_.albedo / exact_pi);
}

Sky make_sky(const SkyModel& model, double elevation, int height) {
  Sky sky;
  sky.height = height, sky.width = 2 * height;
  const size_t width = size_t(sky.width), half = width / 2;
  sky.pixels.resize(width * size_t(height));
  const double e = elevation * exact_pi / 180, r = model.air().ground + eye_height;
  const Vec3 sun{std::cos(e), 0, std::sin(e)};
  const auto fill = [&](size_t first, size_t last, Vec3 light) {
    parallel_for(last - first, 1, [&](size_t begin, size_t end) {
      for (size_t y = first + begin; y < first + end; ++y) {
        const double down = exact_pi * (double(y) + 0.5) / height, z = std::cos(down), s = std::sin(down);
        for (size_t x = 0; x < half; ++x) {
          const double a = exact_pi - 2 * exact_pi * (double(x) + 0.5) / double(width);
          const Vec3f v(model.radiance(r, {s * std::cos(a), s * std::sin(a), z}, sun, light));
          sky.pixels[y * width + x] = sky.pixels[y * width + width - 1 - x] = v;
        }
      }
    });
  };
  // The ground below is lit by the sky above.
  fill(0, size_t(height) / 2, {});
  sky.level = irradiance(sky.pixels, sky.width, sky.height, {0, 0, 1});
  fill(size_t(height) / 2, size_t(height), sky.level);
  // What of the disc stands above the horizon, which lies lower than level.
  const double ratio = model.air().ground / r, dip = std::acos(ratio) * 180 / exact_pi, risen = (elevation + dip) / sun_width + 0.5;
  const double lowest = -std::sqrt(1 - ratio * ratio);
  sky.sun = model.sunlight(r, std::max(std::sin(e), lowest + 1e-6)) * std::clamp(risen, 0.0, 1.0);
  sky.facing = irradiance(sky.pixels, sky.width, sky.height, sun);
  return sky;
}

}  // namespace sg::trace
