// SPDX-License-Identifier: Apache-2.0
// Lines lit by their direction, halos, and alpha along lines.
#include "raster_support.h"
#include "render/shade/illuminated.h"

using namespace sg;
using namespace sg::test;

namespace {

FieldSet rgba(std::vector<float> colors) {
  FieldSet f;
  f.add({"c", Association::point, Array::from_vector(std::move(colors), 4), "", Role::colors});
  return f;
}

/// What a pixel shows over black.
float over_black(const Picture& p, int x, int y, int channel = 0) {
  const size_t i = size_t(y) * size_t(p.frame.width) + size_t(x);
  double sum = 0, rest = 1;
  if (!p.fragments.empty())
    for (uint32_t k = p.fragments.start[i]; k < p.fragments.start[i + 1]; ++k)
      sum += rest * double(p.fragments.fragments[k].rgba[channel]), rest *= 1 - double(p.fragments.fragments[k].rgba[3]);
  return float(sum + rest * double(p.frame.rgba[4 * i + size_t(channel)]));
}

}  // namespace

TEST_CASE("lit lines: brightest across the light, ambient along it, dark on the far side") {
  Material m;
  m.ambient = 0.1f, m.diffuse = 0.9f, m.specular = 0.5f, m.power = 20;
  const Lamp head{{0, 0, 1}, 1};
  float before = 0, light = 0, gloss = 0;
  for (int k = 0; k <= 18; ++k) {
    const double a = k * pi / 36;  // from along the light to across it
    raster::light_line(m, {&head, 1}, {std::sin(a), 0, std::cos(a)}, {0, 0, 1}, light, gloss);
    if (k == 0) CHECK(light == doctest::Approx(0.1));
    else CHECK(light > before);
    CHECK(light == doctest::Approx(0.1 + 0.9 * std::sin(a)));
    before = light;
  }
  CHECK(gloss == doctest::Approx(0.5));  // mirrored straight back
  const Lamp behind{{0, 0, -1}, 1};
  raster::light_line(m, {&behind, 1}, {1, 0, 0}, {0, 0, 1}, light, gloss);
  CHECK(light == doctest::Approx(0.1));
  CHECK(gloss < 1e-6f);
  // The mean of Lambert's law over the visible half, from the side: 1/pi of that from the front.
  const Lamp side{{0, 1, 0}, 1};
  raster::light_line(m, {&side, 1}, {1, 0, 0}, {0, 0, 1}, light, gloss);
  CHECK(light == doctest::Approx(0.1 + 0.9 / pi));
}

TEST_CASE("lit lines: in a picture the line across the light is bright and the one along it dark") {
  Scene s;
  s.lights = {{{1, 0, 0.2}, true, 1}};
  LinesItem across = line({0, -50, 0, 0, 50, 0}, 6), along = line({-90, 70, 0, 90, 70, 0}, 6);
  across.lit = along.lit = true;
  s.items = {across, along};
  const Picture p = draw(s, front_parallel(200), 200, 200);
  CHECK(over_black(p, 100, 100) > 1.6f * over_black(p, 100, 30));
  CHECK(over_black(p, 100, 30) > 0.1f);
  // Unlit ones keep their colour.
  across.lit = along.lit = false;
  s.items = {across, along};
  const Picture q = draw(s, front_parallel(200), 200, 200);
  CHECK(over_black(q, 100, 100) == doctest::Approx(1));
  CHECK(over_black(q, 100, 30) == doctest::Approx(1));
}

TEST_CASE("lit lines: tangents turn smoothly from segment to segment") {
  Scene s;
  LinesItem l = line({0, 0, 0, 1, 0, 0, 1, 1, 0}, 2);
  s.items = {l};
  Context context;
  const auto prepared = prepare_scene(s, context);
  const double h = std::sqrt(0.5);
  const auto close = [](Vec3 a, Vec3 b) { return length(a - b) < 1e-9; };
  CHECK(close(raster::line_tangent(prepared->items[0], 0, 0), {1, 0, 0}));
  CHECK(close(raster::line_tangent(prepared->items[0], 0, 1), {h, h, 0}));
  CHECK(close(raster::line_tangent(prepared->items[0], 1, 0), {h, h, 0}));
  CHECK(close(raster::line_tangent(prepared->items[0], 1, 1), {0, 1, 0}));
}

TEST_CASE("halos: a border hides the line behind, not the line in front and not its neighbour at the same depth") {
  for (const bool parallel : {true, false}) {
    Camera c = parallel ? front_parallel(200, 1000) : front(1000, 2 * std::atan(0.1) * 180 / pi);
    c.far_plane = 5000;
    LinesItem front_line = line({-90, 0, 40, 90, 0, 40}, 4), back = line({0, -90, -40, 0, 90, -40}, 4),
              level = line({50, -90, 39, 50, 90, 39}, 4);
    front_line.halo = back.halo = level.halo = 4;
    front_line.halo_color = back.halo_color = level.halo_color = {0, 0, 0};
    Scene s;
    s.items = {front_line, back, level};
    const Picture p = draw(s, c, 200, 200);
    CHECK(over_black(p, 100, 100) == doctest::Approx(1));  // the line in front
    CHECK(over_black(p, 60, 100) == doctest::Approx(1));
    CHECK(over_black(p, 100, 50) == doctest::Approx(1));  // the line behind, away from it
    CHECK(over_black(p, 100, 96) < 0.1f);                 // and hidden by the halo
    CHECK(over_black(p, 100, 104) < 0.1f);
    CHECK(over_black(p, parallel ? 150 : 152, 104) > 0.9f);  // one level below: not hidden
    s.items = {back};
    CHECK(over_black(draw(s, c, 200, 200), 100, 96) == doctest::Approx(1));  // its own halo does not touch it
  }
}

TEST_CASE("halos: a line that bends towards the viewer is not cut by its own halo") {
  std::vector<float> xyz;
  for (int i = 0; i <= 100; ++i) xyz.insert(xyz.end(), {-80 + 1.6f * float(i), 20 * std::sin(0.1f * float(i)), 0.6f * float(i)});
  LinesItem l = line(xyz, 4);
  Scene s;
  s.items = {l};
  const Picture plain = draw(s, front_parallel(200, 1000), 200, 200);
  l.halo = 5, l.halo_color = {0, 0, 0};
  s.items = {l};
  const Picture p = draw(s, front_parallel(200, 1000), 200, 200);
  size_t full = 0, kept = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x)
      if (over_black(plain, x, y) > 0.99f) ++full, kept += over_black(p, x, y) > 0.9f;
  CHECK(full > 400);
  CHECK(kept == full);
}

TEST_CASE("lines: alpha of a colour field is followed along the line, once at its joints") {
  Scene s;
  LinesItem l = line({-80, 0, 0, 0, 0, 0, 80, 0, 0}, 6, rgba({1, 1, 1, 0.2f, 1, 1, 1, 0.4f, 1, 1, 1, 0.6f}));
  l.color_by.emplace();
  l.color_by->field = "c", l.color_by->direct = true;
  s.items = {l};
  const Picture p = draw(s, front_parallel(200), 200, 200);
  for (const int x : {30, 60, 100, 140, 170})
    CHECK(over_black(p, x, 100) == doctest::Approx(0.2 + 0.4 * (x + 0.5 - 20) / 160).epsilon(0.02));
  l.opacity = 0.5;
  s.items = {l};
  CHECK(over_black(draw(s, front_parallel(200), 200, 200), 60, 100) == doctest::Approx(0.15).epsilon(0.03));
}

TEST_CASE("lines: translucent lines that cross are mixed from near to far in any order of drawing") {
  const auto coloured = [](std::vector<float> xyz, std::vector<float> c) {
    std::vector<float> twice = c;
    twice.insert(twice.end(), c.begin(), c.end());
    LinesItem l = line(std::move(xyz), 6, rgba(twice));
    l.color_by.emplace();
    l.color_by->field = "c", l.color_by->direct = true;
    return l;
  };
  const LinesItem red = coloured({-80, 0, 10, 80, 0, 10}, {1, 0, 0, 0.5f}), green = coloured({0, -80, -10, 0, 80, -10}, {0, 1, 0, 0.5f});
  for (const bool swapped : {false, true}) {
    Scene s;
    if (swapped) s.items = {green, red};
    else s.items = {red, green};
    const Picture p = draw(s, front_parallel(200, 500), 200, 200);
    CHECK(over_black(p, 100, 100, 0) == doctest::Approx(0.5));
    CHECK(over_black(p, 100, 100, 1) == doctest::Approx(0.25));
  }
}

TEST_CASE("lit lines and halos: 1 and 8 threads draw the same bytes") {
  Scene s;
  std::vector<float> xyz;
  for (int i = 0; i <= 20000; ++i) {
    const float t = 0.01f * float(i);
    xyz.insert(xyz.end(), {80 * std::sin(1.01f * t), 80 * std::cos(1.3f * t), 60 * std::sin(0.7f * t)});
  }
  LinesItem l = line(xyz, 2);
  l.lit = true, l.halo = 3, l.opacity = 0.8;
  s.items = {l};
  set_thread_count(1);
  const Picture one = draw(s, front_parallel(200, 1000), 300, 200);
  set_thread_count(8);
  const Picture eight = draw(s, front_parallel(200, 1000), 300, 200);
  set_thread_count(0);
  CHECK_FALSE(one.fragments.empty());
  CHECK(same_bytes(one, eight));
}
