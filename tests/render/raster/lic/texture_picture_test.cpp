// SPDX-License-Identifier: Apache-2.0
// Textures in pictures: samples per pixel, bands, translucency, animation, and what is refused.
#include "scene/show/show.h"
#include "texture_support.h"

using namespace sg;
using namespace sg::test;

namespace {

Frame picture(const Scene& s, int w, int h, int samples) {
  Context context;
  RenderOptions o;
  o.width = w, o.height = h, o.samples = samples;
  return render(s, front_parallel(2), o, context);
}

}  // namespace

TEST_CASE("lic: more samples a pixel, and bands of a picture, have the texture of one sample") {
  const Scene s = scene_of({textured(sheet(16, 4, 0, [](Vec3 p) { return Vec3{-p.y, p.x, 0}; }), 10)});
  const Frame one = picture(s, 900, 700, 1), two = picture(s, 900, 700, 2);  // 2.5 million samples: two bands
  CHECK(same_bytes(one.rgba, two.rgba));
  float lo = 9, hi = 0;
  for (size_t i = 0; i < one.rgba.size(); i += 4) lo = std::min(lo, one.rgba[i]), hi = std::max(hi, one.rgba[i]);
  CHECK(hi > 2 * lo);
}

TEST_CASE("lic: samples at an item's border take the texture beside them") {
  Scene s = scene_of({textured(sheet(8, 0.604, 0, [](Vec3) { return Vec3{1, 0.5, 0}; }), 10)});
  s.transparent = true;
  const Frame two = picture(s, 200, 200, 2);
  const float plain = srgb_decode(0.7f);
  size_t edge = 0, as_plain = 0;
  for (size_t i = 0; i < two.rgba.size(); i += 4)
    if (two.rgba[i + 3] > 0.2f && two.rgba[i + 3] < 0.8f) ++edge, as_plain += std::abs(two.rgba[i] / two.rgba[i + 3] - plain) < 1e-4f;
  CHECK(edge > 200);
  CHECK(as_plain < edge / 10);
}

TEST_CASE("lic: translucent surfaces carry the texture of their nearest side") {
  SurfaceItem s = textured(sheet(8, 2, 0, [](Vec3) { return Vec3{1, 0, 0}; }));
  s.opacity = 0.5;
  const Picture p = draw(scene_of({s}), front_parallel(2), 100, 100);
  REQUIRE(p.fragments.fragments.size() == 100 * 100);
  float lo = 9, hi = 0;
  for (const Fragment& f : p.fragments.fragments) lo = std::min(lo, f.rgba[0]), hi = std::max(hi, f.rgba[0]);
  CHECK(hi > 2 * lo);
}

TEST_CASE("lic: the phases 0 and 1 are the same picture, those between are not, and contrast stays") {
  const auto at = [](std::optional<double> phase) {
    SurfaceItem s = textured(sheet(8, 2, 0, [](Vec3) { return Vec3{1, 0.2, 0}; }), 40);
    s.lic->phase = phase;
    return planes(scene_of({s}), front_parallel(2), 160, 160);
  };
  const auto a = at(0.0), b = at(1.0), c = at(0.25);
  double difference = 0, moved = 0, va = 0, vc = 0;
  for (int y = 0; y < 160; ++y)
    for (int x = 0; x < 160; ++x) {
      const size_t i = a.at(x, y);
      difference += std::abs(double(a.value[i]) - double(b.value[i])), moved += std::abs(double(a.value[i]) - double(c.value[i]));
      va += std::pow(double(a.value[i]), 2), vc += std::pow(double(c.value[i]), 2);
    }
  CHECK(difference / 25600 < 1e-4);
  CHECK(moved / 25600 > 0.3);
  CHECK(vc / va == doctest::Approx(1).epsilon(0.25));
}

TEST_CASE("lic: strength 0 is the plain picture, and brightness stays within its bounds") {
  SurfaceItem s = textured(sheet(8, 2, 0, [](Vec3) { return Vec3{1, 0.2, 0}; }));
  const float base = srgb_decode(0.7f);
  s.lic->strength = 0;
  const Picture none = draw(scene_of({s}), front_parallel(2), 64, 64);
  for (int x = 0; x < 64; ++x) CHECK(none.rgba(x, 30)[0] == doctest::Approx(base));
  s.lic->strength = 1, s.lic->contrast = 100;
  const Picture full = draw(scene_of({s}), front_parallel(2), 64, 64);
  for (int x = 0; x < 64; ++x) {
    CHECK(full.rgba(x, 30)[0] >= 0);
    CHECK(full.rgba(x, 30)[0] <= 1.5f * base + 1e-6f);
  }
}

TEST_CASE("lic: what is no vector field is refused by name") {
  FieldSet f;
  f.add({"s", Association::point, Array::from_vector<float>({1, 2, 3, 4}), ""});
  f.add({"w", Association::whole, Array::from_vector<float>({1, 2, 3}, 3), ""});
  f.add({"v", Association::point, Array::from_vector<float>({1, 0, 1, 0, 1, 0, 1, 0}, 2), ""});
  const DatasetPtr d = quad(1, 0, f);
  const auto drawn = [&](auto&& change) {
    SurfaceItem s = textured(d);
    change(*s.lic);
    draw(scene_of({s}), front_parallel(2), 16, 16);
  };
  CHECK_NOTHROW(drawn([](SurfaceTexture&) {}));  // two components
  CHECK_THROWS_WITH_AS(drawn([](SurfaceTexture& t) { t.field = "s"; }), doctest::Contains("'s' has 1 component"), Error);
  CHECK_THROWS_WITH_AS(drawn([](SurfaceTexture& t) { t.field = "vv"; }), doctest::Contains("did you mean"), Error);
  CHECK_THROWS_AS(drawn([](SurfaceTexture& t) { t.association = Association::whole, t.field = "w"; }), Error);
  CHECK_THROWS_AS(drawn([](SurfaceTexture& t) { t.steps = 0; }), Error);
  CHECK_THROWS_AS(drawn([](SurfaceTexture& t) { t.step = 1.5; }), Error);
  CHECK_THROWS_AS(drawn([](SurfaceTexture& t) { t.grain = 0; }), Error);
  Context context;
  const auto shown = [&](std::vector<std::string> words) {
    Scene s;
    add_show(s, "surface", d, words, context);
    return std::get<SurfaceItem>(s.items.at(0)).lic;
  };
  CHECK_FALSE(shown({}).has_value());
  CHECK(shown({"lic=auto"})->field == "v");
  CHECK(shown({"lic=v", "lic_kernel=box", "lic_steps=7"})->steps == 7);
  CHECK_THROWS_WITH_AS(shown({"lic=s"}), doctest::Contains("'s' has 1 component"), Error);
  CHECK_THROWS_WITH_AS(shown({"lic=w"}), doctest::Contains("whole"), Error);
  CHECK_THROWS_AS(shown({"lic=v", "lic_step=3"}), Error);
}
