// SPDX-License-Identifier: Apache-2.0
#include "color/cie.h"

#include "support/test.h"

using namespace sg;

TEST_CASE("cie: lightness of the sRGB primaries and of a grey") {
  const std::pair<Vec3, double> cases[] = {{{1, 0, 0}, 53.2408},
                                           {{0, 1, 0}, 87.7347},
                                           {{0, 0, 1}, 32.2970},
                                           {{0, 1, 1}, 91.1132},
                                           {{1, 0, 1}, 60.3242},
                                           {{1, 1, 0}, 97.1393},
                                           {Vec3{119, 119, 119} / 255.0, 50.0344},
                                           {{1, 1, 1}, 100}};
  for (const auto& [rgb, lightness] : cases) CHECK(std::abs(srgb_to_lab(rgb).x - lightness) < 1e-4);
  const Vec3 white = srgb_to_lab({1, 1, 1});
  CHECK(std::abs(white.y) + std::abs(white.z) < 1e-10);
}

TEST_CASE("cie: sRGB to Lab and back is the identity, also outside the gamut") {
  for (double r : {-0.2, 0.0, 0.001, 0.04, 0.3, 1.0, 1.2})
    for (double g : {0.0, 0.05, 0.7})
      for (double b : {0.0, 0.02, 0.9}) {
        const Vec3 c{r, g, b}, back = lab_to_srgb(srgb_to_lab(c));
        CHECK(length(back - c) < 1e-9);
      }
  CHECK(in_gamut({0, 0.5, 1}));
  CHECK(!in_gamut({0, 0.5, 1.001}));
}

TEST_CASE("cie: the two branches of L* meet at 216/24389") {
  const double e = 216.0 / 24389.0;
  const auto l = [](double y) { return xyz_to_lab({0.95 * y, y, 1.09 * y}).x; };
  CHECK(l(e) == doctest::Approx(8).epsilon(1e-12));
  CHECK(std::abs(l(e * (1 + 1e-12)) - l(e * (1 - 1e-12))) < 1e-9);
}

TEST_CASE("cie: CIEDE2000 of Sharma's pairs") {
  struct Pair {
    Vec3 a, b;
    double difference;
  };
  const Pair pairs[] = {
      {{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
      {{50, 3.1571, -77.2803}, {50, 0, -82.7485}, 2.8615},
      {{50, 2.8361, -74.0200}, {50, 0, -82.7485}, 3.4412},
      {{50, -1.3802, -84.2814}, {50, 0, -82.7485}, 1.0000},
      {{50, 0, 0}, {50, -1, 2}, 2.3669},
      {{50, 2.5, 0}, {73, 25, -18}, 27.1492},
      {{50, 2.5, 0}, {61, -5, 29}, 22.8977},
      {{50, 2.5, 0}, {58, 24, 15}, 19.4535},
  };
  for (const Pair& p : pairs) {
    CHECK(std::abs(ciede2000(p.a, p.b) - p.difference) < 5e-5);
    CHECK(std::abs(ciede2000(p.b, p.a) - p.difference) < 5e-5);
  }
  CHECK(ciede2000({40, 10, 10}, {40, 10, 10}) == 0);
}
