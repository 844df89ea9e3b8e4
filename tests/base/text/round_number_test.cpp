// SPDX-License-Identifier: Apache-2.0
#include "base/text/round_number.h"

#include "base/random.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("round numbers: the fewest digits within reach") {
  CHECK(round_near(0.4837, 0.05) == 0.5);
  CHECK(round_near(0.3141, 0.02) == 0.3);
  CHECK(round_near(1147.2, 100) == 1200);
  CHECK(round_near(1147.2, 20) == 1150);
  CHECK(round_near(-37.4, 4) == -40);
  CHECK(round_near(0.02, 0.05) == 0);
  CHECK(round_near(101325, 3) == 101325);
  CHECK(round_near(7, 0) == 7);
  CHECK(std::isnan(round_near(std::nan(""), 1)));
}

TEST_CASE("round numbers: never farther than allowed, the same with the sign turned, of any size") {
  for (uint64_t i = 0; i < 2000; ++i) {
    const double size = std::pow(10.0, 40 * random_unit(1, i) - 20), v = size * (2 * random_unit(2, i) - 1);
    const double within = size * std::pow(10.0, -6 * random_unit(3, i));
    const double r = round_near(v, within);
    CHECK(std::abs(r - v) <= within);
    CHECK(round_near(-v, within) == -r);
  }
}
