// SPDX-License-Identifier: Apache-2.0
#include "image/image.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "base/parallel.h"
#include "support/test.h"

using namespace sg;

namespace {

Frame ramp(int width, int height) {
  Frame f(width, height);
  for (size_t i = 0; i < f.pixels(); ++i) {
    const float x = float(i) / float(f.pixels() - 1), a = 0.25f + 0.75f * x;
    f.rgba[4 * i] = x * a, f.rgba[4 * i + 1] = x * x * a, f.rgba[4 * i + 2] = (1 - x) * a, f.rgba[4 * i + 3] = a;
  }
  return f;
}

}  // namespace

TEST_CASE("image: the sRGB curve is the standard's") {
  CHECK(srgb_encode(0) == 0);
  CHECK(srgb_encode(1) == 1);
  CHECK(srgb_encode(0.0031308f) == doctest::Approx(0.040449936f));
  CHECK(srgb_encode(0.5f) == doctest::Approx(0.7353569f));
  CHECK(srgb_decode(0.5f) == doctest::Approx(0.2140411f));
  for (int i = 0; i <= 1000; ++i)
    CHECK(srgb_decode(srgb_encode(float(i) / 1000)) == doctest::Approx(float(i) / 1000).epsilon(1e-5).scale(1e-3));
}

TEST_CASE("image: 8-bit codes equal the rounded formula for floats of every size") {
  // A sweep over the bit patterns of floats from 0 to just above 1, and every neighbour of each threshold.
  std::vector<float> values{0.0f, -1.0f, 1.0f, 2.0f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()};
  for (uint32_t bits = 0; bits < std::bit_cast<uint32_t>(1.01f); bits += 3331) values.push_back(std::bit_cast<float>(bits));
  for (int code = 1; code < 256; ++code) {
    const uint32_t middle = std::bit_cast<uint32_t>(srgb_decode((float(code) - 0.5f) / 255));
    for (uint32_t bits = middle - 20; bits < middle + 20; ++bits) values.push_back(std::bit_cast<float>(bits));
  }
  Frame f(int(values.size()), 1);
  for (size_t i = 0; i < values.size(); ++i) f.rgba[4 * i] = values[i];
  const Image image = to_image(f);
  int wrong = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    const float v = values[i] > 0 ? std::min(values[i], 1.0f) : 0;
    wrong += image.pixels[3 * i] != int(255 * srgb_encode(v) + 0.5f);
  }
  CHECK(wrong == 0);
}

TEST_CASE("image: transparent pictures have straight alpha") {
  Frame f(3, 1);
  const float pixels[12] = {0.25f, 0, 0.5f, 0.5f, 0, 0, 0, 0, 1, 0.5f, 0.25f, 1};
  std::copy(pixels, pixels + 12, f.rgba.begin());
  const Image image = to_image(f, true);
  REQUIRE(image.channels == 4);
  const std::vector<uint8_t> right{188, 0, 255, 128, 0, 0, 0, 0, 255, 188, 137, 255};
  CHECK(image.pixels == right);
  CHECK(to_image(f).channels == 3);
  CHECK(to_image(f).pixels[0] == 137);  // premultiplied: over black
}

TEST_CASE("image: the same bytes for 1 and 8 threads") {
  const Frame f = ramp(301, 203);
  set_thread_count(1);
  const Image one = to_image(f, true);
  set_thread_count(8);
  CHECK(to_image(f, true).pixels == one.pixels);
  set_thread_count(0);
}
