// SPDX-License-Identifier: Apache-2.0
#include "image/enlarge.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("enlarge: linear between the middles of pixels, and nothing outside") {
  for (const int channels : {3, 4}) {
    Image part(7, 5, channels), whole(40, 30, channels);
    for (size_t i = 0; i < part.pixels.size(); ++i) part.pixels[i] = uint8_t(256 * random_unit(3, i));
    std::fill(whole.pixels.begin(), whole.pixels.end(), uint8_t(99));
    const int x0 = 3, y0 = 4, w = 31, h = 22;
    paste_enlarged(part, x0, y0, w, h, whole);
    double worst = 0;
    for (int y = 0; y < 30; ++y)
      for (int x = 0; x < 40; ++x)
        for (int c = 0; c < channels; ++c) {
          const bool inside = x >= x0 && x < x0 + w && y >= y0 && y < y0 + h;
          double expected = 99;
          if (inside) {
            const double u = std::min(std::max((x - x0 + 0.5) * 7 / w - 0.5, 0.0), 6.0),
                         v = std::min(std::max((y - y0 + 0.5) * 5 / h - 0.5, 0.0), 4.0);
            const int i = std::min(int(u), 5), j = std::min(int(v), 3);
            const double a = u - i, b = v - j;
            expected = (1 - b) * ((1 - a) * part.at(i, j)[c] + a * part.at(i + 1, j)[c]) +
                       b * ((1 - a) * part.at(i, j + 1)[c] + a * part.at(i + 1, j + 1)[c]);
          }
          worst = std::max(worst, std::abs(expected - whole.at(x, y)[c]));
        }
    CHECK(worst <= 2.5);  // shares are rounded down to 1/256, twice
  }
}

TEST_CASE("enlarge: one colour stays that colour") {
  Image part(3, 2, 3), whole(64, 48, 3);
  std::fill(part.pixels.begin(), part.pixels.end(), uint8_t(201));
  paste_enlarged(part, 0, 0, 64, 48, whole);
  CHECK(std::all_of(whole.pixels.begin(), whole.pixels.end(), [](uint8_t v) { return v == 201; }));
}
