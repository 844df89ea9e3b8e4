// SPDX-License-Identifier: Apache-2.0
#include "render/trace/material/fresnel.h"

#include <complex>

#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using doctest::Approx;

TEST_CASE("fresnel: .04 at eta 1.5, nothing of the p part at Brewster's angle, all beyond the critical angle") {
  CHECK(fresnel_dielectric(1, 1.5f).reflected() == Approx(.04).epsilon(1e-6));
  CHECK(fresnel_dielectric(1, 1 / 1.5f).reflected() == Approx(.04).epsilon(1e-6));
  for (const float eta : {1.333f, 1.5f, 2.4f, 1 / 1.5f}) {
    const Fresnel brewster = fresnel_dielectric(std::cos(std::atan(eta)), eta);
    CHECK(brewster.p < 1e-12f);
    CHECK(brewster.s > 1e-3f);
    CHECK(fresnel_dielectric(0, eta).reflected() == 1);
  }
  const double critical = std::asin(1 / 1.5);
  CHECK(fresnel_dielectric(float(std::cos(critical + 1e-3)), 1 / 1.5f).reflected() == 1);
  CHECK(fresnel_dielectric(float(std::cos(critical - 1e-3)), 1 / 1.5f).reflected() < .9f);
  CHECK(fresnel_dielectric(.3f, 1).reflected() == 0);
}

TEST_CASE("fresnel: what is reflected and what passes add up, by the amplitudes of the passing waves; both ways reflect alike") {
  for (const float eta : {1.1f, 1.5f, 3.f, .8f})
    for (int i = 1; i <= 20; ++i) {
      const float cosine = float(i) / 20;
      const Fresnel f = fresnel_dielectric(cosine, eta);
      if (f.cosine_through == 0) continue;
      // Amplitudes t of Fresnel's equations; power passes by eta cos_t / cos_i times their squares.
      const double c = double(cosine), t = double(f.cosine_through), e = double(eta), power = e * t / c;
      const double ts = 2 * c / (c + e * t), tp = 2 * c / (e * c + t);
      CHECK(double(f.s) + power * ts * ts == Approx(1).epsilon(2e-6));
      CHECK(double(f.p) + power * tp * tp == Approx(1).epsilon(2e-6));
      CHECK(fresnel_dielectric(f.cosine_through, 1 / eta).reflected() == Approx(f.reflected()).epsilon(1e-4));
    }
}

TEST_CASE("fresnel: conductors by complex refraction, and without absorption as transparent matter") {
  for (const auto& [eta, k] : {std::pair{.221f, 3.215f}, {2.9f, 3.f}, {1.335f, 1.872f}, {1.5f, 0.f}})
    for (int i = 0; i <= 20; ++i) {
      const double c = i / 20.;
      const std::complex<double> n{double(eta), double(k)}, t = std::sqrt(1. - (1 - c * c) / (n * n));
      const double expected = (std::norm((c - n * t) / (c + n * t)) + std::norm((n * c - t) / (n * c + t))) / 2;
      CHECK(fresnel_conductor(float(c), eta, k) == Approx(expected).epsilon(1e-5));
    }
}

TEST_CASE("fresnel: Schlick's approximation is near from both sides, and exact straight on and beyond the critical angle") {
  for (const float eta : {1.5f, 1 / 1.5f}) {
    CHECK(fresnel_schlick(1, eta) == Approx(.04).epsilon(1e-5));
    for (int i = 1; i <= 20; ++i) {
      const float cosine = float(i) / 20, exact = fresnel_dielectric(cosine, eta).reflected();
      CHECK(std::abs(fresnel_schlick(cosine, eta) - exact) < .08f);
      if (exact == 1) CHECK(fresnel_schlick(cosine, eta) == 1);
    }
  }
  CHECK(fresnel_schlick(0, Vec3f(.2f, .5f, 1)) == Vec3f(1, 1, 1));
}

TEST_CASE("fresnel: a sheet reflects the sum of all that goes to and fro in it") {
  for (const double r : {.04, .3, .9}) {
    double sum = r, inside = (1 - r) * r;
    for (int i = 0; i < 1000; ++i) sum += inside * (1 - r), inside *= r * r;
    CHECK(sheet_reflectance(float(r)) == Approx(sum).epsilon(1e-6));
  }
}
