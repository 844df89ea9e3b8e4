// SPDX-License-Identifier: Apache-2.0
#include "render/trace/light/sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/parallel.h"
#include "render/trace/light/luminance.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using doctest::Approx;

namespace {

constexpr double sky_pi = std::numbers::pi;

const SkyModel& model() {
  static const SkyModel m(Atmosphere{});
  return m;
}
Vec3 at(double elevation, double azimuth) {
  const double e = elevation * sky_pi / 180, a = azimuth * sky_pi / 180;
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}
double eye() { return model().air().ground + 200; }

}  // namespace

TEST_CASE("sky: the table of sunlight is the integral, at all heights of sun and eye") {
  const Atmosphere& a = model().air();
  for (const double h : {0.0, 500.0, 5e3, 30e3, 59e3})
    for (const double degrees : {0.0, 40.0, 70.0, 85.0, 89.0, 90.0}) {
      const double r = a.ground + h, mu = std::cos(degrees * sky_pi / 180);
      const Vec3 exact = transmittance(a, r, mu, 2000), found = model().sunlight(r, mu);
      CAPTURE(h);
      CAPTURE(degrees);
      for (int c = 0; c < 3; ++c) CHECK(std::abs(found[c] - exact[c]) < 3e-3);
    }
  CHECK(model().sunlight(a.ground + 1000, -0.5) == Vec3());
}

TEST_CASE("sky: of thin air overhead it is the closed form of single scattering") {
  // beta H (1 - e^(-top / H)) times the phase function, as all light arrives.
  Atmosphere thin;
  thin.mie_scattering = thin.mie_extinction = 0, thin.ozone = {}, thin.albedo = 0, thin.rayleigh = thin.rayleigh * 1e-4;
  const SkyModel m(thin, 400);
  const double cosine = std::sin(50 * sky_pi / 180), phase = 3 / (16 * sky_pi) * (1 + cosine * cosine);
  const Vec3 seen = m.radiance(thin.ground, {0, 0, 1}, at(50, 0), {}, false);
  for (int c = 0; c < 3; ++c)
    CHECK(seen[c] == Approx(thin.rayleigh[c] * thin.rayleigh_height * (1 - std::exp(-60e3 / thin.rayleigh_height)) * phase).epsilon(1e-3));
}

TEST_CASE("sky: the error of lines of sight falls with their steps") {
  const SkyModel fine(Atmosphere{}, 1600), coarse(Atmosphere{}, 25), twice(Atmosphere{}, 50);
  for (const Vec3 d : {at(90, 0), at(40, 90), at(10, 150)}) {
    const double exact = fine.radiance(eye(), d, at(20, 0), {}).y;
    const double a = std::abs(coarse.radiance(eye(), d, at(20, 0), {}).y - exact),
                 b = std::abs(twice.radiance(eye(), d, at(20, 0), {}).y - exact);
    CHECK(b < 0.5 * a + 1e-5 * exact);
    CHECK(b < 0.01 * exact);
  }
}

TEST_CASE("sky: it is symmetric about the plane of the sun, blue above, warm about a low sun, and dark in no place by day") {
  for (const double z : {80.0, 30.0, 5.0})
    for (const double a : {20.0, 90.0, 170.0}) {
      const Vec3 left = model().radiance(eye(), at(z, a), at(25, 0), {}), right = model().radiance(eye(), at(z, -a), at(25, 0), {});
      for (int c = 0; c < 3; ++c) CHECK(left[c] == Approx(right[c]).epsilon(1e-12));
    }
  const Vec3 zenith = model().radiance(eye(), {0, 0, 1}, at(60, 0), {});
  CHECK(zenith.z > 2 * zenith.x);
  const Vec3 warm = model().radiance(eye(), at(2, 0), at(2, 0), {});
  CHECK(warm.x > 1.5 * warm.z);
  for (const double elevation : {60.0, 20.0, 5.0, -2.0}) {
    const Sky sky = make_sky(model(), elevation, 32);
    CHECK(sky.width == 64);
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 64; ++x) {
        const Vec3f v = sky.pixels[size_t(y * 64 + x)];
        CHECK(v == sky.pixels[size_t(y * 64 + 63 - x)]);
        for (int c = 0; c < 3; ++c) CHECK((std::isfinite(v[c]) && v[c] > 0));
      }
    CHECK((luminance(Vec3f(sky.sun)) > 0) == (elevation > 0));
  }
}

TEST_CASE("sky: no more light leaves the air than enters it") {
  // Air and ground that absorb nothing of what they scatter, over black ground: what enters reaches the ground or leaves at the top.
  Atmosphere white;
  white.mie_extinction = white.mie_scattering, white.ozone = {}, white.albedo = 0;
  const SkyModel m(white, 100);
  for (const double elevation : {60.0, 30.0}) {
    const double mu = std::sin(elevation * sky_pi / 180);
    const Sky sky = make_sky(m, elevation, 64);
    Vec3 leaves;
    constexpr int rings = 64, spokes = 32;
    for (int i = 0; i < rings; ++i)
      for (int k = 0; k < spokes; ++k) {
        // Even in the square of the sine: each direction carries the same flux.
        const double s2 = (i + 0.5) / rings, s = std::sqrt(s2), a = 2 * sky_pi * (k + 0.5) / spokes;
        leaves += m.radiance(white.top - 1, {s * std::cos(a), s * std::sin(a), -std::sqrt(1 - s2)}, at(elevation, 0), {}) *
                  (sky_pi / (rings * spokes));
      }
    for (int c = 0; c < 3; ++c) {
      const double total = (sky.level[c] + sky.sun[c] * mu + leaves[c]) / mu;
      CAPTURE(elevation);
      CAPTURE(c);
      CHECK(total < 1.005);
      CHECK(total > 0.93);
    }
  }
  // With ozone and dust that absorbs, less.
  for (const double elevation : {60.0, 20.0, 5.0}) {
    const Sky sky = make_sky(model(), elevation, 32);
    const double mu = std::sin(elevation * sky_pi / 180);
    for (int c = 0; c < 3; ++c) CHECK(sky.level[c] + sky.sun[c] * mu < mu);
  }
}

TEST_CASE("sky: the same for any number of threads") {
  const int before = thread_count();
  set_thread_count(1);
  const Sky one = make_sky(SkyModel(Atmosphere{}), 10, 16);
  set_thread_count(4);
  const Sky many = make_sky(SkyModel(Atmosphere{}), 10, 16);
  set_thread_count(before);
  CHECK(one.pixels == many.pixels);
  CHECK(one.sun == many.sun);
}
