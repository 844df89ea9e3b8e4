// SPDX-License-Identifier: Apache-2.0
// render(): samples, background, transparency.
#include "raster_support.h"

using namespace sg;
using namespace sg::test;

namespace {

Frame picture(const Scene& s, const Camera& c, const RenderOptions& o) {
  Context context;
  return render(s, c, o, context);
}

}  // namespace

TEST_CASE("render: the background is flat, a gradient, or not there") {
  Scene s;
  s.background = {0.5f, 0.6f, 0.7f};
  Frame f = picture(s, front(), {8, 5, 0});
  CHECK(f.rgba[0] == srgb_decode(0.5f));
  CHECK(f.rgba[4 * 39 + 2] == srgb_decode(0.7f));
  CHECK(f.rgba[3] == 1);
  s.background_top = Vec3f{1, 0, 0};
  f = picture(s, front(), {8, 5, 0});
  CHECK(f.rgba[0] == 1);                                                    // top row
  CHECK(f.rgba[4 * 39] == srgb_decode(0.5f));                               // bottom row
  CHECK(f.rgba[4 * 16 + 1] == doctest::Approx(double(srgb_decode(0.3f))));  // the middle of the gradient
  s.transparent = true;
  f = picture(s, front(), {8, 5, 0});
  for (float v : f.rgba) CHECK(v == 0);
  for (uint32_t id : f.ids) CHECK(id == 0);
}

TEST_CASE("render: samples are averaged in linear light; depth and id are the nearest") {
  // A white quad whose edge runs through the middle of pixel columns: 4 x 4 samples see half of it.
  Scene s;
  s.background = {0, 0, 0};
  s.items = {item(surface({0.5f, -9, 0, 9, -9, 0, 9, 9, 0, 0.5f, 9, 0}, {0, 1, 2, 0, 2, 3}), {1, 1, 1}, false),
             item(quad(9, -1), {0, 0, 0}, false)};
  const Camera c = front_parallel(8);
  const Frame f = picture(s, c, {8, 8, 4});
  CHECK(f.rgba[4 * (3 * 8 + 4)] == doctest::Approx(0.5));
  CHECK(f.rgba[4 * (3 * 8 + 3)] == 0);
  CHECK(f.rgba[4 * (3 * 8 + 5)] == 1);
  CHECK(f.depth[3 * 8 + 4] == doctest::Approx(10));
  CHECK(f.ids[3 * 8 + 4] == 1);
  CHECK(f.ids[3 * 8 + 3] == 2);
  s.transparent = true, s.items.pop_back();
  const Frame t = picture(s, c, {8, 8, 4});
  CHECK(t.rgba[4 * (3 * 8 + 4) + 3] == doctest::Approx(0.5));
  CHECK(t.rgba[4 * (3 * 8 + 4)] == doctest::Approx(0.5));  // premultiplied
}

TEST_CASE("render: more samples bring the picture nearer to its limit") {
  Scene s;
  s.items = {item(torus(60, 40))};
  const Camera c = fit_camera(scene_bounds(s), {1, 2, 3}, {0, 0, 1}, 1);
  const Frame best = picture(s, c, {64, 64, 8});
  double last = 1e9;
  for (int n : {1, 2, 4}) {
    const Frame f = picture(s, c, {64, 64, n});
    double sum = 0;
    for (size_t i = 0; i < f.rgba.size(); ++i) sum += std::abs(double(f.rgba[i]) - double(best.rgba[i]));
    CHECK(sum < 0.75 * last);
    last = sum;
  }
}

TEST_CASE("render: mistakes are told") {
  CHECK(error_of([] { picture({}, front(), {0, 10, 1}); }).find("0x10") != std::string::npos);
  CHECK(error_of([] { picture({}, front(), {10, 10, 99}); }).find("99 samples") != std::string::npos);
}
