// SPDX-License-Identifier: Apache-2.0
#include "render/shade/black_body.h"
#include "support/test.h"

using namespace sg;
using doctest::Approx;

TEST_CASE("black_body: chromaticities on Planck's locus, and Wien's law in luminance") {
  // Illuminant A is a black body of 2856 K: (.44758, .40745); 6500 K: (.3135, .3237) (CIE 15). The fit of the observer is right to .004.
  struct Row {
    double kelvin, x, y;
  };
  for (const Row& r : {Row{2856, 0.44758, 0.40745}, Row{6500, 0.3135, 0.3237}}) {
    const Vec3 c = black_body_xyz(r.kelvin);
    CHECK(c.x / (c.x + c.y + c.z) == Approx(r.x).epsilon(0.01));
    CHECK(c.y / (c.x + c.y + c.z) == Approx(r.y).epsilon(0.01));
  }
  // Around 560 nm the slope of log luminance over 1/T is -c2 / 580 nm, to a few per cent.
  const double slope = std::log(black_body_xyz(1500).y / black_body_xyz(1400).y) / (1.0 / 1500 - 1.0 / 1400);
  CHECK(slope == Approx(-1.438777e7 / 585).epsilon(0.04));
  const Vec3 hot = black_body(1800, 1800);
  CHECK(0.2126 * hot.x + 0.7152 * hot.y + 0.0722 * hot.z == Approx(1).epsilon(1e-3));
  CHECK(hot.x > hot.y);
  CHECK(hot.y > hot.z);
  CHECK(black_body(50, 1800) == Vec3());
}
