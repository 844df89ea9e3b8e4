// SPDX-License-Identifier: Apache-2.0
#include "image/texture/lookup.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "image/texture/patterns.h"
#include "support/test.h"

using namespace sg;
using doctest::Approx;

namespace {

using enum TextureFilter;

Texture ramp(int width, int height) {
  std::vector<Vec4f> texels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) texels.push_back({float((x + 0.5) / width), float((y + 0.5) / height), 1, 1});
  return {width, height, std::move(texels)};
}

Texture black_and_white() { return pattern_texture(TexturePattern::checker, {0, 0, 0}, {1, 1, 1}); }
/// The endless checkerboard that it shows, without a filter: two squares in a length of 1.
double checker(double u, double v) { return (int64_t(std::floor(2 * u)) + int64_t(std::floor(2 * v))) % 2 == 0 ? 0 : 1; }

/// What the pixel sees of it: the mean over the parallelogram of its footprint.
double seen(const TexturePlace& p) {
  constexpr int n = 400;
  double sum = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double s = (i + 0.5) / n - 0.5, t = (j + 0.5) / n - 0.5;
      sum += checker(p.at.x + s * p.right.x + t * p.down.x, p.at.y + s * p.right.y + t * p.down.y);
    }
  return sum / (n * n);
}

/// The root of the mean square of what a filter is off, over places and turns of a footprint, in lengths of the checkerboard's squares.
double error_of_filter(TextureFilter filter, double longer, double shorter) {
  // Drawn finely, as a picture is, so that its levels matter.
  std::vector<Vec4f> texels;
  constexpr int size = 64;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const auto v = float(checker((x + 0.5) / size, (y + 0.5) / size));
      texels.push_back({v, v, v, 1});
    }
  const Texture t(size, size, std::move(texels));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(0, 1);
  double sum = 0;
  constexpr int tries = 60;
  for (int i = 0; i < tries; ++i) {
    const double angle = std::numbers::pi * number(random), c = std::cos(angle), s = std::sin(angle);
    const TexturePlace p{{number(random), number(random)}, {longer / 2 * c, longer / 2 * s}, {-shorter / 2 * s, shorter / 2 * c}};
    TextureLookup lookup;
    lookup.filter = filter;
    const double off = double(lookup(t, p).x) - seen(p);
    sum += off * off;
  }
  return std::sqrt(sum / tries);
}

}  // namespace

TEST_CASE("texture lookup: bilinear is exact on linear ramps, and at texels' middles all filters give the texel") {
  const Texture t = ramp(13, 7);
  TextureLookup lookup;
  for (const TextureFilter f : {bilinear, trilinear, anisotropic}) {
    lookup.filter = f;
    for (double u = 0.05; u < 0.95; u += 0.07)
      for (double v = 0.1; v < 0.9; v += 0.09) {
        const Vec4f c = lookup(t, {{u, v}, {0.01, 0}, {0, 0.01}});
        CHECK(c.x == Approx(u).epsilon(1e-5));
        CHECK(c.y == Approx(v).epsilon(1e-5));
        CHECK(c.w == Approx(1));
      }
  }
  for (const TextureFilter f : {nearest, bilinear, trilinear, anisotropic}) {
    lookup.filter = f;
    const Vec4f c = lookup(t, {{4.5 / 13, 2.5 / 7}, {}, {}}), texel = t.levels()[0].at(4, 2);
    CHECK(c.x == Approx(texel.x));
    CHECK(c.y == Approx(texel.y));
  }
}

TEST_CASE("texture lookup: beyond the picture it is repeated, mirrored or held") {
  const Texture t = ramp(4, 1);
  TextureLookup lookup;
  lookup.filter = nearest;
  const auto at = [&](TextureWrap wrap, double u) {
    lookup.wrap_u = lookup.wrap_v = wrap;
    return double(lookup(t, {{u, 0.5}, {}, {}}).x);
  };
  const double first = 0.125, second = 0.375, last = 0.875;
  CHECK(at(TextureWrap::repeat, 1.1) == first);
  CHECK(at(TextureWrap::repeat, -0.1) == last);
  CHECK(at(TextureWrap::repeat, -3.7) == second);
  CHECK(at(TextureWrap::mirror, 1.1) == last);
  CHECK(at(TextureWrap::mirror, -0.1) == first);
  CHECK(at(TextureWrap::mirror, 2.3) == second);
  CHECK(at(TextureWrap::clamp, 1.1) == last);
  CHECK(at(TextureWrap::clamp, -1e300) == first);
  CHECK(at(TextureWrap::repeat, 1e15) == first);
  // Between the last texel and what follows it.
  lookup.filter = bilinear;
  CHECK(at(TextureWrap::repeat, 1.0) == Approx((first + last) / 2));
  CHECK(at(TextureWrap::mirror, 1.0) == Approx(last));
  CHECK(at(TextureWrap::clamp, 1.0) == Approx(last));
}

TEST_CASE("texture lookup: a checkerboard far away is grey") {
  const Texture t = black_and_white();
  TextureLookup lookup;
  for (const TextureFilter f : {trilinear, anisotropic}) {
    lookup.filter = f;
    for (const double size : {1.0, 3.3, 1e6}) CHECK(lookup(t, {{0.3, 0.71}, {size, 0}, {0, size}}).x == Approx(0.5));
  }
  // On the horizon, too.
  lookup.filter = anisotropic;
  CHECK(lookup(t, {{0.3, 0.71}, {1, 0}, {0, 1e9}}).x == Approx(0.5));
  const double inf = std::numeric_limits<double>::infinity();
  CHECK(lookup(t, {{0.3, 0.71}, {1, 0}, {0, inf}}).x == Approx(0.5));
}

TEST_CASE("texture lookup: of a sharp checkerboard near by a pixel sees the mean of what is in it") {
  const Texture t = black_and_white();
  TextureLookup lookup;
  lookup.sharp = true;
  for (double u = -1; u < 1; u += 0.013) {
    const TexturePlace p{{u, u / 3 + 0.1}, {0.04, 0}, {0, 0.07}};
    CHECK(double(lookup(t, p).x) == Approx(seen(p)).epsilon(0.02));
  }
}

TEST_CASE("texture lookup: at a slant the anisotropic filter comes near to what is seen, where the trilinear one blurs") {
  // Lengths in squares of the board; at most 16 to 1.
  for (const auto& [longer, shorter] : {std::pair{0.8, 0.1}, {2.0, 0.2}, {3.0, 0.25}}) {
    CAPTURE(longer);
    const double around = error_of_filter(anisotropic, longer, shorter), blurred = error_of_filter(trilinear, longer, shorter);
    CHECK(around < 0.02);
    CHECK(around < blurred / 10);
  }
  // From straight above both are the same.
  CHECK(error_of_filter(anisotropic, 0.3, 0.3) == Approx(error_of_filter(trilinear, 0.3, 0.3)).epsilon(1e-3));
  CHECK(error_of_filter(trilinear, 0.3, 0.3) < 0.12);
}

TEST_CASE("texture lookup: places that are nowhere have no colour") {
  const Texture t = black_and_white();
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  CHECK(TextureLookup()(t, {{nan, 0}, {}, {}}) == Vec4f());
  CHECK(TextureLookup()(t, {{0, inf}, {}, {}}) == Vec4f());
}
