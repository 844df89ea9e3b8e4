// SPDX-License-Identifier: Apache-2.0
#include "render/shade/phase.h"

#include <vector>

#include "support/statistics.h"
#include "support/test.h"

using namespace sg;
using doctest::Approx;

namespace {

struct Sphere {
  double whole = 0, cosine = 0, square = 0;
};
Sphere over_sphere(auto f) {
  Sphere s;
  const int n = 20'000;
  for (int i = 0; i < n; ++i) {
    const double c = -1 + (i + .5) * 2 / n, part = double(f(float(c))) * 4 * M_PI / n;
    s.whole += part, s.cosine += part * c, s.square += part * c * c;
  }
  return s;
}

// Chance of the cosines of evenly spread u.
double chance(auto draw, auto f) {
  const int n = 40'000, bins = 32;
  std::vector<double> observed(bins), expected(bins);
  for (int i = 0; i < n; ++i) ++observed[size_t(std::min(int((double(draw((float(i) + .5f) / n)) + 1) / 2 * bins), bins - 1))];
  for (int i = 0; i < bins * 100; ++i)
    expected[size_t(i / 100)] += n * double(f(float(-1 + (i + .5) / (bins * 50)))) * 4 * M_PI / (bins * 100);
  return test::chi_square_chance(observed, expected);
}

}  // namespace

TEST_CASE("phase: Henyey-Greenstein has norm 1, mean cosine g, known values, and is sampled in proportion") {
  CHECK(henyey_greenstein(-1, .6f) == Approx(.01243398).epsilon(1e-5));
  CHECK(henyey_greenstein(0, .6f) == Approx(.03211159).epsilon(1e-5));
  CHECK(henyey_greenstein(1, .6f) == Approx(.79577472).epsilon(1e-5));
  for (const float g : {-.7f, -1e-4f, 0.f, 2e-3f, .6f, .9f}) {
    const Sphere s = over_sphere([&](float c) { return henyey_greenstein(c, g); });
    CHECK(s.whole == Approx(1).epsilon(1e-4));
    CHECK(std::abs(s.cosine - double(g)) < 1e-4);
    CHECK(chance([&](float u) { return sample_henyey_greenstein(g, u); }, [&](float c) { return henyey_greenstein(c, g); }) > .9);
  }
}

TEST_CASE("phase: Rayleigh has norm 1, mean cosine 0, mean square 2/5, and is sampled in proportion") {
  CHECK(rayleigh(0) == Approx(.0596831).epsilon(1e-5));
  CHECK(rayleigh(1) == Approx(.1193662).epsilon(1e-5));
  const Sphere s = over_sphere(rayleigh);
  CHECK(s.whole == Approx(1).epsilon(1e-5));
  CHECK(std::abs(s.cosine) < 1e-5);
  CHECK(s.square == Approx(.4).epsilon(1e-5));
  CHECK(chance(sample_rayleigh, rayleigh) > .9);
}
