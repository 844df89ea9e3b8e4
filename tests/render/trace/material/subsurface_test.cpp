// SPDX-License-Identifier: Apache-2.0
#include "render/trace/material/subsurface.h"

#include <vector>

#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using doctest::Approx;

namespace {

// What an isotropic half-space of single-scatter albedo a returns of diffuse light: 1 - 2 sqrt(1 - a) times the first moment of
// Chandrasekhar's H function, whose equation is iterated.
double half_space(double a) {
  const int n = 400;
  std::vector<double> h(n, 1.0);
  for (int round = 0; round < 400; ++round)
    for (int i = 0; i < n; ++i) {
      double sum = 0;
      for (int j = 0; j < n; ++j) sum += h[size_t(j)] * (j + .5) / (i + j + 1) / n;
      h[size_t(i)] = (h[size_t(i)] + 1 / (std::sqrt(1 - a) + a / 2 * sum)) / 2;
    }
  double moment = 0;
  for (int i = 0; i < n; ++i) moment += h[size_t(i)] * (i + .5) / n / n;
  return 1 - 2 * std::sqrt(1 - a) * moment;
}

}  // namespace

TEST_CASE("subsurface: the albedo of scattering gives back the colour of the surface, by Chandrasekhar's exact half-space") {
  for (const double a : {.3, .8, .95, .99}) {
    const float surface = float(half_space(a));
    CHECK(single_scatter_albedo({surface, surface, surface}, 0).x == Approx(a).epsilon(4e-3));
  }
  CHECK(single_scatter_albedo({0, .5f, 1}, 0).x == Approx(0).epsilon(.02));
  CHECK(single_scatter_albedo({0, .5f, 1}, .9f).z == 1);
}

TEST_CASE("subsurface: forward scattering is made up for: the reduced albedo (1 - g) a / (1 - g a) stays") {
  const float a = single_scatter_albedo({.6f, .6f, .6f}, 0).x;
  for (const float g : {-.5f, .5f, .9f}) {
    const float b = single_scatter_albedo({.6f, .6f, .6f}, g).x;
    CHECK((1 - g) * b / (1 - g * b) == Approx(double(a)).epsilon(1e-4));
  }
}

TEST_CASE("subsurface: the diffusion profile integrates to the albedo, and its distances are those of its density") {
  for (const float surface : {.2f, .8f, 1.f}) {
    const DiffusionProfile profile(.7f, surface);
    const int n = 4000;
    // r = -log(1 - v) stretches the plane to the unit interval.
    double whole = 0, within = 0;
    for (int i = 0; i < n; ++i) {
      const double v = (i + .5) / n, r = -4 * std::log1p(-v), part = 2 * M_PI * r * double(profile(float(r))) * 4 / (1 - v) / n;
      whole += part, within += r < .5 ? part : 0;
    }
    CHECK(whole == Approx(double(surface)).epsilon(2e-3));
    int nearer = 0;
    for (int i = 0; i < n; ++i) nearer += profile.sample((float(i) + .5f) / n) < .5f;
    CHECK(nearer / double(n) == Approx(within / whole).epsilon(5e-3));
  }
}

TEST_CASE("subsurface: colours of thick bodies and the shares that make them are each other's inverse") {
  for (const float g : {0.f, 0.5f, -0.4f})
    for (float c = 0; c <= 1; c += 0.125f) {
      const Vec3f back = surface_albedo(single_scatter_albedo({c, c, c}, g), g);
      CHECK(back.x == doctest::Approx(c).epsilon(1e-4));
    }
}
