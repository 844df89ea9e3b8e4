// SPDX-License-Identifier: Apache-2.0
#include "image/texture/texture.h"

#include <limits>
#include <random>

#include "image/codec.h"
#include "image/texture/patterns.h"
#include "image/texture/texture_file.h"
#include "support/test.h"

using namespace sg;
using doctest::Approx;

namespace {

Texture random_texture(int width, int height) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> number(0, 1);
  std::vector<Vec4f> texels;
  for (int i = 0; i < width * height; ++i) texels.push_back({number(random), number(random), number(random), number(random)});
  return {width, height, std::move(texels)};
}

double mean_of(const Texture::Level& l, int c) {
  double sum = 0;
  for (const Vec4f& t : l.texels) sum += double(t[c]);
  return sum / double(l.texels.size());
}

}  // namespace

TEST_CASE("texture: every mip level keeps the mean, of any size of picture") {
  for (const auto& [w, h] : {std::pair{16, 16}, {17, 5}, {1, 9}, {100, 3}, {31, 63}}) {
    const Texture t = random_texture(w, h);
    CAPTURE(w);
    CHECK(t.levels().back().texels.size() == 1);
    for (const Texture::Level& l : t.levels())
      for (int c = 0; c < 4; ++c) CHECK(mean_of(l, c) == Approx(mean_of(t.levels()[0], c)).epsilon(1e-5));
  }
}

TEST_CASE("texture: texels of an odd row's half are the means of what they cover") {
  // 0 1 2 3 4 on five texels: two halves of 2.5 texels each.
  std::vector<Vec4f> texels;
  for (int i = 0; i < 5; ++i) texels.push_back({float(i), 0, 0, 1});
  const Texture t(5, 1, texels);
  REQUIRE(t.levels()[1].width == 2);
  CHECK(t.levels()[1].at(0, 0).x == Approx((0 + 1 + 0.5 * 2) / 2.5));
  CHECK(t.levels()[1].at(1, 0).x == Approx((0.5 * 2 + 3 + 4) / 2.5));
}

TEST_CASE("texture: colours of a screen are decoded before they are averaged, numbers are not") {
  Image picture(2, 1, 1);
  picture.pixels = {0, 255};
  CHECK(Texture::of(picture, TexelEncoding::srgb).levels()[1].at(0, 0).x == Approx(0.5));
  picture.pixels = {128, 128};
  CHECK(Texture::of(picture, TexelEncoding::srgb).levels()[1].at(0, 0).x == Approx(srgb_decode(128 / 255.f)));
  CHECK(Texture::of(picture, TexelEncoding::linear).levels()[1].at(0, 0).x == Approx(128 / 255.0));
}

TEST_CASE("texture: what nobody sees gives no fringe") {
  Image picture(2, 2, 4);  // red, and green that is not there at all
  picture.pixels = {255, 0, 0, 255, 0, 255, 0, 0, 255, 0, 0, 255, 0, 255, 0, 0};
  const Texture t = Texture::of(picture, TexelEncoding::srgb);
  CHECK(t.translucent());
  const Vec4f mean = t.levels().back().texels[0];
  CHECK(mean == Vec4f{0.5f, 0, 0, 0.5f});
  const Texture opaque = Texture::of(picture, TexelEncoding::srgb, false);
  CHECK_FALSE(opaque.translucent());
  CHECK(opaque.levels().back().texels[0] == Vec4f{0.5f, 0.5f, 0, 1});
}

TEST_CASE("texture: texels that are not finite hold no colour, and the others keep theirs") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  LinearPicture picture{2, 2, {{0.25f, 0.5f, 1}, {nan, 0, 0}, {0, inf, 0}, {0.75f, 0.5f, 1}}};
  const Texture t = Texture::of(picture);
  CHECK(t.translucent());
  const Vec4f mean = t.levels().back().texels[0];
  CHECK(mean.w == Approx(0.5));
  CHECK(mean.x / mean.w == Approx(0.5));
  CHECK(mean.y / mean.w == Approx(0.5));
}

TEST_CASE("texture: rows of pictures run from the top, those of textures from the bottom") {
  Image picture(1, 2, 1);
  picture.pixels = {255, 0};
  const Texture t = Texture::of(picture, TexelEncoding::linear);
  CHECK(t.levels()[0].at(0, 0).x == 0);
  CHECK(t.levels()[0].at(0, 1).x == 1);
}

TEST_CASE("texture: files are told apart by their content, and others are refused") {
  Image picture(3, 2, 3);
  for (size_t i = 0; i < picture.pixels.size(); ++i) picture.pixels[i] = uint8_t(i / 3 * 40);
  const std::vector<uint8_t> png = encode_png(picture);
  const std::string jpeg = encode_jpeg(picture, 100);
  const Texture a = decode_texture(std::as_bytes(std::span(png)), "a", TexelEncoding::linear, true);
  const Texture b = decode_texture(std::as_bytes(std::span(jpeg)), "b", TexelEncoding::linear, true);
  CHECK(a.width() == 3);
  CHECK(a.levels()[0].at(0, 0).x == Approx(120 / 255.0));
  CHECK(b.levels()[0].at(0, 0).x == Approx(120 / 255.0).epsilon(0.03));
  for (const auto bytes : {std::as_bytes(std::span(png)), std::as_bytes(std::span(jpeg))}) {
    CHECK(texture_memory(bytes) == Approx(6 * (16 * 4 / 3.0 + 4)));
    CHECK(texture_memory(bytes.first(12)) == 0);
  }
  const std::string text = "P6 not for us";
  const auto refused = [&](std::span<const std::byte> bytes) {
    return test::error_of([&] { decode_texture(bytes, "wood.ppm", TexelEncoding::srgb, true); });
  };
  CHECK(refused(std::as_bytes(std::span(text))).find("wood.ppm") != std::string::npos);
  CHECK(refused(std::as_bytes(std::span(png)).first(40)).find("wood.ppm") != std::string::npos);
  CHECK(refused(std::as_bytes(std::span(jpeg)).first(40)).find("wood.ppm") != std::string::npos);
  CHECK(refused({}).find("PNG") != std::string::npos);
}

TEST_CASE("texture: noise is without seams and reaches both colours") {
  const Texture t = pattern_texture(TexturePattern::noise, {0, 0, 0}, {1, 1, 1});
  const Texture::Level& l = t.levels()[0];
  float lo = 1, hi = 0, inner = 0, seam = 0;
  for (int y = 0; y < l.height; ++y)
    for (int x = 0; x < l.width; ++x) {
      lo = std::min(lo, l.at(x, y).x), hi = std::max(hi, l.at(x, y).x);
      float& step = x + 1 < l.width ? inner : seam;
      step = std::max(step, std::abs(l.at(x, y).x - l.at((x + 1) % l.width, y).x));
    }
  CHECK(lo == 0);
  CHECK(hi == 1);
  CHECK(seam < 1.5f * inner);
}
