// SPDX-License-Identifier: Apache-2.0
#include "render/trace/light/atmosphere.h"

#include <cmath>
#include <numbers>

#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using doctest::Approx;

namespace {

constexpr double air_pi = std::numbers::pi;

/// Air that only scatters as molecules do, and thins out into space.
Atmosphere molecules() {
  Atmosphere a;
  a.mie_scattering = a.mie_extinction = 0, a.ozone = {}, a.top = a.ground + 200e3;
  return a;
}

double depth_of(const Atmosphere& a, double degrees, int steps) {
  const double mu = std::cos(degrees * air_pi / 180);
  return optical_depth(a, a.ground, mu, air_path(a, a.ground, mu).length, steps).x;
}

}  // namespace

TEST_CASE("atmosphere: straight up the optical depth is that of the coefficients times their heights, and of half the tent") {
  const Atmosphere a;
  const Vec3 found = optical_depth(a, a.ground, 1, 60e3, 20'000);
  for (int c = 0; c < 3; ++c) {
    const double rayleigh = a.rayleigh[c] * a.rayleigh_height * (1 - std::exp(-60e3 / a.rayleigh_height));
    const double mie = a.mie_extinction * a.mie_height * (1 - std::exp(-60e3 / a.mie_height));
    CHECK(found[c] == Approx(rayleigh + mie + a.ozone[c] * a.ozone_width / 2).epsilon(1e-6));
  }
  const Vec3 left = transmittance(a, a.ground, 1, 20'000);
  CHECK(left.z == Approx(std::exp(-found.z)).epsilon(1e-9));
}

TEST_CASE("atmosphere: at a slant it is that of plane layers, but for their bending, and level that of Chapman") {
  const Atmosphere a = molecules();
  const double up = a.rayleigh.x * a.rayleigh_height, x = a.ground / a.rayleigh_height;
  // 1 / cos less its first correction by the bend: tan^2 / (cos x).
  for (const double degrees : {30.0, 60.0}) {
    const double c = std::cos(degrees * air_pi / 180), t2 = 1 / (c * c) - 1;
    CHECK(depth_of(a, degrees, 4000) / up == Approx((1 - t2 / x) / c).epsilon(1e-4));
  }
  // Level: x e^x K1(x) = sqrt(pi x / 2) (1 + 3/(8x) - 15/(128 x^2) ...).
  const double chapman = std::sqrt(air_pi * x / 2) * (1 + 3 / (8 * x) - 15 / (128 * x * x));
  CHECK(depth_of(a, 90, 4000) / up == Approx(chapman).epsilon(1e-5));
}

TEST_CASE("atmosphere: the error of the midpoint rule falls with the square of the steps") {
  const Atmosphere a = molecules();
  for (const double degrees : {0.0, 75.0, 90.0}) {
    const double exact = depth_of(a, degrees, 20'000);
    const double coarse = std::abs(depth_of(a, degrees, 40) - exact), fine = std::abs(depth_of(a, degrees, 80) - exact);
    CAPTURE(degrees);
    CHECK(std::log2(coarse / fine) == Approx(2).epsilon(0.08));
  }
}

TEST_CASE("atmosphere: paths end at the ground or at the top") {
  const Atmosphere a;
  CHECK(air_path(a, a.ground, 1).length == Approx(60e3).epsilon(1e-12));
  CHECK(air_path(a, a.ground, 0).length == Approx(std::sqrt(60e3 * (a.top + a.ground))).epsilon(1e-12));
  const AirPath down = air_path(a, a.top, -1);
  CHECK(down.meets_ground);
  CHECK(down.length == Approx(60e3).epsilon(1e-12));
  // From the top past the ground and out again.
  const double mu = -0.1;
  const AirPath past = air_path(a, a.top, mu);
  CHECK_FALSE(past.meets_ground);
  CHECK(past.length == Approx(-2 * a.top * mu).epsilon(1e-12));
  CHECK(transmittance(a, a.ground + 100, -0.5, 100) == Vec3());
  CHECK(air_path(a, a.top, 0.5).length == Approx(0).epsilon(1e-9));
}

TEST_CASE("atmosphere: the lower the sun, the redder and the darker") {
  const Atmosphere a;
  Vec3 before{1, 1, 1};
  double redder = 0;
  for (double degrees = 0; degrees <= 90; degrees += 2.5) {
    const Vec3 left = transmittance(a, a.ground, std::cos(degrees * air_pi / 180), 2000);
    CAPTURE(degrees);
    CHECK(left.x / left.z > redder);
    for (int c = 0; c < 3; ++c) CHECK(left[c] < before[c]);
    redder = left.x / left.z, before = left;
  }
  CHECK(transmittance(Atmosphere::with_haze(5), a.ground, 0.3, 500).y < transmittance(a, a.ground, 0.3, 500).y);
}
