// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/annotate.h"

#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <tuple>

#include "base/file/file.h"
#include "image/codec.h"
#include "render/annotate/axes.h"
#include "render/annotate/legend/legend.h"
#include "render/annotate/overlay/overlay.h"
#include "render/annotate/patient_sides.h"
#include "render/annotate/scale_bar.h"
#include "render/annotate/texts.h"
#include "support/test.h"

using namespace sg;

namespace {

Projection look(Vec3 towards_viewer, const Box3& box, int width, int height, bool parallel = false) {
  Projection p;
  p.width = width, p.height = height, p.parallel = parallel;
  const Vec3 d = normalize(towards_viewer);
  p.forward = -d;
  p.right = normalize(cross(p.forward, std::abs(d.z) > 0.99 ? Vec3{0, 1, 0} : Vec3{0, 0, 1}));
  p.up = cross(p.right, p.forward);
  const double distance = 2.2 * box.diagonal();
  p.eye = box.center() + d * distance;
  p.scale = 0.6 * std::min(width, height) / box.diagonal() * (parallel ? 1 : distance);
  return p;
}

const Box3 unit_box{{0, 0, 0}, {1, 2, 1.5}};

Image blank(int width, int height, int channels = 3, uint8_t value = 255) {
  Image image(width, height, channels);
  std::fill(image.pixels.begin(), image.pixels.end(), value);
  return image;
}

ColorScale temperature() {
  ColorScale s;
  s.map = find_colormap("sight");
  s.lo = 293.15, s.hi = 1273, s.title = "temperature", s.unit = "K";
  return s;
}

ColorScale materials(int n) {
  ColorScale s;
  s.map = find_colormap("labels");
  s.title = "material";
  for (int i = 0; i < n; ++i)
    s.labels.push_back(3 * i),
        s.label_names.push_back(i % 4 == 3 ? "a material whose name does not want to end" : fmt::format("part {}", i));
  return s;
}

bool same(const uint8_t* p, Vec4f c) {
  for (int k = 0; k < 3; ++k)
    if (p[k] != int(255 * c[k] + 0.5f)) return false;
  return true;
}

std::vector<LegendLayout> layouts(const Annotation& a, int width, int height, double font) {
  const Overlay overlay(1, 1, false);
  return layout_legends(overlay, a.legends, {0, 0, double(width), double(height)}, font, a.show_nan_in_legend);
}

size_t changed(const Image& before, const Image& after, const Rect& r) {
  size_t n = 0;
  for (int y = std::max(0, int(r.y)); y < std::min(before.height, int(r.bottom())); ++y)
    for (int x = std::max(0, int(r.x)); x < std::min(before.width, int(r.right())); ++x)
      n += std::memcmp(before.at(x, y), after.at(x, y), 3) != 0;
  return n;
}

size_t changed_on_border(const Image& a, const Image& b) {
  const double w = a.width, h = a.height;
  return changed(a, b, {0, 0, w, 1}) + changed(a, b, {0, h - 1, w, 1}) + changed(a, b, {0, 0, 1, h}) + changed(a, b, {w - 1, 0, 1, h});
}

/// Everything at once.
Annotation full() {
  Annotation a;
  a.title =
      "Heating of a blade with internal cooling channels, case 42, mesh with 12 million cells, time 0.0123 s, solved with many models";
  a.legends = {temperature(), temperature(), materials(40)};
  a.legends[1].title = "turbulent_kinetic_energy_dissipation_rate", a.legends[1].unit = "m\u00b2/s\u00b3";
  a.legends[1].kind = ScaleKind::log, a.legends[1].lo = 3e-7;
  a.legends[1].above = Vec3f{1, 0, 1}, a.legends[1].below = Vec3f{0, 0, 0.5f};
  a.show_nan_in_legend = true;
  a.box = Box3{{1e6, -2000, -1e-5}, {1e6 + 0.5, -2000 + 0.25, 0.4}};
  a.length_unit = "mm";
  return a;
}

}  // namespace

TEST_CASE("overlay: a place where a line may break takes no room, controls are spelled out") {
  const Overlay overlay(400, 100, false);
  const TextStyle style;
  const double plain = overlay.measure("velocity_magnitude", style).width;
  CHECK(overlay.measure("velocity_\u200bmagnitude", style).width == doctest::Approx(plain));
  CHECK(overlay.measure("velocity_\u202emagnitude", style).width ==
        doctest::Approx(overlay.measure("velocity_\\u202emagnitude", style).width));
  TextStyle narrow;
  narrow.wrap = 0.7 * plain, narrow.break_words = false;
  CHECK(overlay.measure("velocity_\u200bmagnitude", narrow).lines == 2);
  // A unit stays whole.
  TextStyle unit = style;
  unit.break_words = false, unit.wrap = 0.5 * overlay.measure("mol/l", style).width;
  CHECK(overlay.measure("mol/l", unit).lines == 2);
  CHECK(overlay.measure("mol/\u2060l", unit).lines == 1);
}

TEST_CASE("annotate: the row of every number on a legend has exactly that number's colour") {
  for (ScaleKind kind : {ScaleKind::linear, ScaleKind::log, ScaleKind::symlog})
    for (bool reversed : {false, true}) {
      Annotation a;
      a.triad = false;
      a.legends = {temperature()};
      ColorScale& s = a.legends[0];
      s.kind = kind;
      if (kind == ScaleKind::symlog) s.lo = -1000, s.linear_threshold = 1;
      if (reversed) std::swap(s.lo, s.hi);
      Image image = blank(1280, 720);
      annotate(image, a, look({1, -1, 1}, unit_box, 1280, 720));
      const LegendLayout l = layouts(a, 1280, 720, 15)[0];
      CHECK(l.ticks.size() >= 3);
      for (const auto& t : l.ticks) {
        INFO(t.text);
        for (int x = int(l.bar.x); x < int(l.bar.right()); ++x) CHECK(same(image.at(x, t.row), s.color(t.value)));
        CHECK(std::abs(t.row - (l.bar.y + (1 - s.position(t.value)) * (l.bar.height - 1))) <= 0.5);
      }
      CHECK(same(image.at(int(l.bar.x), int(l.bar.y)), s.color(s.hi)));
      CHECK(same(image.at(int(l.bar.x), int(l.bar.bottom()) - 1), s.color(s.lo)));
      CHECK(std::memcmp(image.at(int(l.bar.x), int(l.bar.bottom())), image.at(int(l.bar.x), int(l.bar.bottom()) - 1), 3) != 0);
    }
}

TEST_CASE("annotate: swatches of labels, of NaN, and triangles show exactly their colours") {
  Annotation a;
  a.triad = false;
  a.show_nan_in_legend = true;
  a.legends = {materials(6), temperature()};
  a.legends[1].above = Vec3f{1, 0, 1};
  Image image = blank(1280, 720);
  annotate(image, a, look({1, -1, 1}, unit_box, 1280, 720));
  const auto l = layouts(a, 1280, 720, 15);
  REQUIRE(l[0].swatches == 6);
  for (size_t i = 0; i < 6; ++i)
    CHECK(same(image.at(int(l[0].bar.x + 5), int(l[0].bar.y + (double(i) + 0.5) * l[0].row_height)),
               a.legends[0].color(a.legends[0].labels[i])));
  CHECK(same(image.at(int(l[0].bar.x + 5), int(l[0].nan_at.y + 5)), a.legends[0].color(std::nan(""))));
  CHECK(l[1].above);
  CHECK(!l[1].below);
  CHECK(same(image.at(int(l[1].bar.x + 0.5 * l[1].bar.width), int(l[1].bar.y - 7)), {1, 0, 1, 1}));
}

TEST_CASE("annotate: more labels than rows end in how many more there are") {
  Annotation a;
  a.legends = {materials(100)};
  const LegendLayout l = layouts(a, 640, 480, 10)[0];
  CHECK(l.swatches < 100);
  CHECK(l.rows.size() == l.swatches + 1);
  CHECK(l.rows.back() == fmt::format("\u2026 {} more", 100 - l.swatches));
}

TEST_CASE("annotate: nothing reaches the border of the picture, at any size, from any side") {
  for (const auto& [w, h] : {std::pair{1280, 720}, {640, 480}, {300, 200}, {200, 500}, {90, 60}})
    for (Vec3 d : {Vec3{1, -1.5, 0.8}, {-1, -1, -1}, {0, 0, 1}, {0.02, -1, 0.01}}) {
      const Annotation a = full();
      const Image before = blank(w, h);
      Image after = before;
      annotate(after, a, look(d, *a.box, w, h));
      INFO(w << " x " << h);
      CHECK(changed(before, after, {0, 0, double(w), double(h)}) > size_t(w * h) / 100);
      CHECK(changed_on_border(before, after) == 0);
    }
}

TEST_CASE("annotate: legends stand side by side within the width that legend_room tells") {
  Annotation a = full();
  a.box.reset();
  a.triad = false;
  a.title.clear();
  for (const auto& [w, h, font] : {std::tuple{1280, 720, 15.0}, {1920, 1080, 22.5}, {640, 480, 10.0}}) {
    const auto l = layouts(a, w, h, font);
    for (size_t i = 1; i < l.size(); ++i) CHECK(l[i - 1].column.right() + l[i].font <= l[i].column.x);
    for (const auto& each : l) {
      CHECK(each.bar.x + each.bar.width + each.label_width <= each.column.right());
      CHECK(each.bar.y >= each.column.y);
      CHECK(each.bar.bottom() <= each.column.bottom());
    }
    const int width = legend_room(a, w, h).right;
    CHECK(width > 0);
    CHECK(width <= w * 6 / 10);
    const Image before = blank(w, h);
    Image after = before;
    annotate(after, a, look({1, -1, 1}, unit_box, w, h));
    CHECK(changed(before, after, {0, 0, double(w - width), double(h)}) == 0);
    CHECK(changed(before, after, {double(w - width), 0, double(width), double(h)}) > 1000);
  }
  a.legends.clear();
  CHECK(legend_room(a, 1280, 720).right == 0);
}

TEST_CASE("annotate: numbers on a legend do not touch, and read differently far from zero") {
  Annotation a;
  a.legends = {temperature()};
  a.legends[0].lo = 1e7, a.legends[0].hi = 1e7 + 0.02;
  const LegendLayout l = layouts(a, 1280, 720, 15)[0];
  CHECK(l.ticks.size() >= 4);
  for (size_t i = 0; i < l.ticks.size(); ++i)
    for (size_t j = 0; j < i; ++j) {
      CHECK(std::abs(l.ticks[i].row - l.ticks[j].row) >= 16);
      CHECK(l.ticks[i].text != l.ticks[j].text);
    }
}

TEST_CASE("annotate: a legend has the numbers that are stated, in the stated format") {
  Annotation a;
  a.legends = {temperature()};
  ColorScale& s = a.legends[0];
  s.lo = 0, s.hi = 100, s.ticks = {0, 12.5, 100, 250}, s.number_format = ".1f";
  const LegendLayout l = layouts(a, 1280, 720, 15)[0];
  REQUIRE(l.ticks.size() == 3);  // 250 lies beyond the scale
  const char* texts[] = {"0.0", "12.5", "100.0"};
  for (size_t i = 0; i < 3; ++i) {
    CHECK(l.ticks[i].text == texts[i]);
    CHECK(l.ticks[i].row == int(l.bar.y + std::lround((1 - s.position(s.ticks[i])) * (l.bar.height - 1))));
  }
  s.ticks = {};
  const LegendLayout automatic = layouts(a, 1280, 720, 15)[0];
  for (const auto& t : automatic.ticks) CHECK(t.text.substr(t.text.size() - 2, 1) == ".");
}

TEST_CASE("scale bar: the longest round length that has room, as long as it is in the picture") {
  Camera camera;
  camera.position = {0, 0, 10}, camera.target = {}, camera.up = {0, 1, 0};
  camera.parallel = true, camera.parallel_height = 4;
  const Projection flat = make_projection(camera, 400, 200);  // 50 pixels a unit
  CHECK(scale_bar(flat, {}, 99)->length == 1);
  CHECK(scale_bar(flat, {}, 101)->length == 2);
  CHECK(scale_bar(flat, {}, 260)->length == 5);
  CHECK(scale_bar(flat, {}, 260)->pixels == doctest::Approx(250));
  CHECK(scale_bar(flat, {}, 49)->length == doctest::Approx(0.5));
  camera.parallel = false, camera.view_angle = 90;
  const Projection deep = make_projection(camera, 400, 200);  // at depth 10 the height is 20 units: 10 pixels a unit
  CHECK(scale_bar(deep, {}, 60)->length == 5);
  CHECK(scale_bar(deep, {}, 60)->pixels == doctest::Approx(50));
  CHECK(scale_bar(deep, {0, 0, 5}, 60)->length == 2);
  CHECK(!scale_bar(deep, {0, 0, 20}, 60));
}

TEST_CASE("annotate: long legend titles wrap at blanks and underscores or run upwards, and stay inside the column") {
  Annotation a;
  a.legends = {temperature()};
  for (const char* title : {"turbulent kinetic energy dissipation rate", "turbulent_kinetic_energy_dissipation_rate",
                            "Wasserstoffperoxidkonzentrationsgradientenbetrag"}) {
    a.legends[0].title = title;
    const LegendLayout l = layouts(a, 1280, 720, 15)[0];
    INFO(title);
    CHECK(l.title_size.lines <= 3);
    CHECK((l.title_upwards ? l.title_size.height : l.title_size.width) <= l.column.width);
    CHECK((l.title_upwards ? l.title_size.width : l.title_size.height) <= l.column.height);
  }
}

TEST_CASE("annotate: axes lie on the silhouette, and ticks where their points are seen") {
  const int w = 1280, h = 720;
  Annotation a;
  a.box = unit_box;
  a.triad = false;
  for (bool parallel : {false, true})
    for (Vec3 d : {Vec3{1, -1.5, 0.8}, {-1, -1, -1}, {1, 0.3, 2}, {-2, 1, -0.4}}) {
      const Projection p = look(d, unit_box, w, h, parallel);
      const auto axes = box_axes(unit_box, p);
      CHECK(axes.size() == 3);
      const Image before = blank(w, h);
      Image after = before;
      annotate(after, a, p);
      for (const BoxAxis& axis : axes) {
        // The whole box lies on one side of the edge.
        const Vec3 from = p.to_pixel(axis.from);
        for (int i = 0; i < 8; ++i) {
          const Vec3 q = p.to_pixel({i & 1 ? 1.0 : 0, i & 2 ? 2.0 : 0, i & 4 ? 1.5 : 0});
          CHECK((q.x - from.x) * axis.outward.x + (q.y - from.y) * axis.outward.y <= 1e-6);
        }
        // At value 1 there is a tick: ink a few pixels outward of its projection; between ticks there is none.
        const auto inked = [&](double value) {
          Vec3 world = axis.from;
          world[axis.axis] = value;
          const Vec3 q = p.to_pixel(world);
          const double x = q.x + 5 * axis.outward.x, y = q.y + 5 * axis.outward.y;
          return changed(before, after, {x - 0.5, y - 0.5, 1.5, 1.5}) > 0;
        };
        CHECK(inked(1));
        CHECK(!inked(0.86));
      }
    }
}

TEST_CASE("annotate: no axis where it is seen end on or the box surrounds the viewer") {
  const auto front = box_axes(unit_box, look({0, 0, 1}, unit_box, 800, 600, true));
  REQUIRE(front.size() == 2);
  CHECK(front[0].axis == 0);
  CHECK(front[0].outward.y > 0.99);  // x below
  CHECK(front[1].axis == 1);
  CHECK(front[1].outward.x < -0.99);  // y left
  Projection inside = look({1, 1, 1}, unit_box, 800, 600);
  inside.eye = unit_box.center();
  CHECK(box_axes(unit_box, inside).empty());
  CHECK(box_axes(Box3{}, inside).empty());
  const Box3 flat{{0, 0, 0}, {1, 1, 0}};
  CHECK(box_axes(flat, look({0, 0, 1}, flat, 800, 600)).size() == 2);
  CHECK(box_axes(flat, look({1, -1, 1}, flat, 800, 600)).size() == 2);
}

TEST_CASE("annotate: axes keep clear of legends") {
  Annotation a;
  a.box = unit_box;
  a.triad = false;
  a.legends = {temperature()};
  Image image = blank(400, 700);
  Projection p = look({1, -1.5, 0.8}, unit_box, 400, 700);
  p.scale *= 2;  // the box reaches under the legend
  annotate(image, a, p);
  const LegendLayout l = layouts(a, 400, 700, 9)[0];
  for (int y = int(l.bar.y); y < int(l.bar.bottom()); ++y) {
    CHECK(std::memcmp(image.at(int(l.bar.x), y), image.at(int(l.bar.right()) - 1, y), 3) == 0);
    CHECK(image.at(int(l.bar.x), y)[2] != 255);
  }
}

TEST_CASE("annotate: text grows with the picture and with the scale") {
  Annotation a;
  a.legends = {temperature()};
  const int at720 = legend_room(a, 1280, 720).right, at1440 = legend_room(a, 2560, 1440).right;
  CHECK(at1440 == doctest::Approx(2 * at720).epsilon(0.03));
  a.scale = 2;
  CHECK(legend_room(a, 1280, 720).right == doctest::Approx(at1440).epsilon(0.03));
}

TEST_CASE("annotate: transparent pictures become opaque where there is ink and stay clear elsewhere") {
  Annotation a;
  a.legends = {temperature()};
  Image image = blank(640, 480, 4, 0);
  annotate(image, a, look({1, -1, 1}, unit_box, 640, 480));
  CHECK(image.at(200, 100)[3] == 0);
  const LegendLayout l = layouts(a, 640, 480, 10)[0];
  CHECK(image.at(int(l.bar.x) + 2, int(l.bar.y) + 2)[3] == 255);
  size_t partly = 0;
  for (size_t i = 3; i < image.pixels.size(); i += 4) partly += image.pixels[i] > 0 && image.pixels[i] < 255;
  CHECK(partly > 100);
}

TEST_CASE("annotate: dark backgrounds get light letters") {
  Annotation a;
  a.title = "III";
  a.triad = false;
  a.dark_background = true;
  Image image = blank(640, 480, 3, 0);
  annotate(image, a, look({1, -1, 1}, unit_box, 640, 480));
  CHECK(*std::max_element(image.pixels.begin(), image.pixels.end()) > 180);
}

TEST_CASE("annotate: the same bytes every time; broken UTF-8 and strange numbers do no harm") {
  Annotation a = full();
  a.title = "caf\xe9 \xff";
  a.legends[0].lo = a.legends[0].hi = std::nan("");
  a.legends[1].lo = -1;  // a log scale that cannot be
  ColorScale constant = temperature();
  constant.lo = constant.hi = 5;
  a.legends.push_back(constant);
  Image one = blank(1280, 720), two = one;
  annotate(one, a, look({1, -1, 1}, *a.box, 1280, 720));
  annotate(two, a, look({1, -1, 1}, *a.box, 1280, 720));
  CHECK(one.pixels == two.pixels);
}

TEST_CASE("annotate: wrong images are refused") {
  const Projection p = look({1, -1, 1}, unit_box, 64, 48);
  Image grey(64, 48, 1), none(0, 0, 3);
  CHECK(test::error_of([&] { annotate(grey, {}, p); }).find("3 or 4 channels are needed") != std::string::npos);
  CHECK(test::error_of([&] { annotate(none, {}, p); }).find("without pixels") != std::string::npos);
  Image wide(40000, 1, 3);
  CHECK(test::error_of([&] { annotate(wide, {}, p); }).find("32767") != std::string::npos);
}

TEST_CASE("annotate: numbers are typeset") {
  CHECK(typeset_number("-1.5") == "\u22121.5");
  CHECK(typeset_number("1e-6") == "10\u207b\u2076");
  CHECK(typeset_number("2.5e+07") == "2.5\u00b710\u2077");
  CHECK(typeset_number("300") == "300");
}

// Runs in a process of its own, started by the test below: fontconfig reads its settings once.
TEST_CASE("annotate child: without fonts" * doctest::skip(!std::getenv("SG_TEST_WITHOUT_FONTS"))) {
  Image image = blank(64, 48);
  Annotation a;
  a.title = "x";
  CHECK(test::error_of([&] { annotate(image, a, look({1, -1, 1}, unit_box, 64, 48)); }).find("fonts-dejavu-core") != std::string::npos);
}

TEST_CASE("annotate: without any font the error names the package") {
  const std::string config = test::temp_folder() + "no-fonts.conf";
  write_file(config, "<?xml version=\"1.0\"?><!DOCTYPE fontconfig SYSTEM \"fonts.dtd\"><fontconfig></fontconfig>\n");
  char self[4096] = {};
  REQUIRE(::readlink("/proc/self/exe", self, sizeof self - 1) > 0);
  const std::string command =
      fmt::format("SG_TEST_WITHOUT_FONTS=1 FONTCONFIG_FILE='{}' '{}' -tc='annotate child*' >/dev/null 2>&1", config, self);
  CHECK(std::system(command.c_str()) == 0);
}

TEST_CASE("texts: turned as their direction is seen, never upside down; those that meet another are left out") {
  const Projection p = look({0, 0, 1}, unit_box, 400, 300, true);
  const double degree = 3.14159265358979323846 / 180;
  CHECK(text_angle({{}, {1, 0, 0}, "1"}, p) == doctest::Approx(0));
  CHECK(text_angle({{}, {1, 1, 0}, "1"}, p) == doctest::Approx(45 * degree));
  CHECK(text_angle({{}, {-1, 1, 0}, "1"}, p) == doctest::Approx(-45 * degree));
  CHECK(text_angle({{}, {0, -1, 0}, "1"}, p) == doctest::Approx(90 * degree));
  CHECK(text_angle({{}, {0, 0, 1}, "1"}, p) == 0);
  const auto dark = [&](const std::vector<TextItem>& texts) {
    Annotation a;
    a.triad = false, a.texts = texts;
    Image image = blank(400, 300);
    annotate(image, a, p);
    return std::count_if(image.pixels.begin(), image.pixels.end(), [](uint8_t c) { return c < 100; });
  };
  const Vec3 middle = unit_box.center();
  const auto one = dark({{middle, {1, 0.5, 0}, "988"}});
  CHECK(one > 30);
  CHECK(dark({{middle, {1, 0.5, 0}, "988"}, {middle, {0, 1, 0}, "992"}}) == one);
  CHECK(dark({{middle + Vec3(1000, 0, 0), {1, 0, 0}, "988"}}) == 0);
}

TEST_CASE("legend: bands show their limits, each band in its own colour") {
  ColorScale s;
  s.map = find_colormap("sight");
  s.labels = {0, 1, 2}, s.limits = {988, 992, 996, 1000}, s.title = "pressure";
  const Overlay o(1, 1, false);
  const auto l = layout_legends(o, {s}, {0, 0, 640, 480}, 12, false);
  REQUIRE(l.size() == 1);
  REQUIRE(l[0].ticks.size() == 4);
  CHECK(l[0].ticks[0].text == "988");
  CHECK(l[0].ticks[3].text == "1000");
  CHECK(l[0].ticks[3].row == int(l[0].bar.y));
  Annotation a;
  a.legends = {s}, a.triad = false;
  Image image = blank(640, 480);
  annotate(image, a, look({0, 0, 1}, unit_box, 640, 480));
  for (int band = 0; band < 3; ++band) {
    size_t found = 0;
    for (int y = 0; y < 480; ++y)
      for (int x = 0; x < 640; ++x) found += same(image.at(x, y), s.color(band));
    CHECK(found > 500);
  }
}

TEST_CASE("legend: a glyph of a round value stands above the bar, as long as it is in the picture, and never beyond the column") {
  Overlay overlay(600, 500, false);
  ColorScale scale;
  scale.map = find_colormap("sight");
  scale.lo = 0, scale.hi = 12, scale.title = "wind";
  for (const double pixels : {0.3, 4.0, 25.0, 400.0}) {
    Legend legend(scale);
    legend.glyph = GlyphLegend{1, false, true, 12, "m/s", pixels};
    const LegendLayout l = layout_legends(overlay, {legend}, {0, 0, 600, 500}, 15, false)[0];
    const double value = l.glyph.width / pixels, power = std::pow(10, std::floor(std::log10(value) + 1e-9));
    CHECK(value <= 12);
    CHECK(l.glyph.width <= 5 * 15);
    const double digit = value / power;
    CHECK((digit == doctest::Approx(1) || digit == doctest::Approx(2) || digit == doctest::Approx(5)));
    CHECK(l.glyph_text == typeset_number(fmt::format("{:.3g}", value)) + " m/s");
    CHECK(l.glyph.bottom() < l.bar.y);
    CHECK(l.glyph.right() < l.column.right());
    Image image(600, 500, 3);
    std::fill(image.pixels.begin(), image.pixels.end(), uint8_t(255));
    draw_legend(image, overlay, legend, l);
    overlay.put_on(image);
    const uint8_t* p = image.at(int(l.glyph.x + 0.9 * l.glyph.width), int(l.glyph.y + 0.5 * l.glyph.height));
    if (l.glyph.width > 20) CHECK(p[0] + p[1] + p[2] < 700);
  }
  Legend none(scale);
  none.glyph = GlyphLegend{1, false, true, 12, "m/s", 0};
  CHECK(layout_legends(overlay, {none}, {0, 0, 600, 500}, 15, false)[0].glyph.width == 0);
}

TEST_CASE("annotate: names of any length are laid out in no time, with their beginning and their end") {
  Image image(640, 400, 3);
  Annotation a;
  Legend l;
  l.title.assign(20000, 'x');
  l.title += "end";
  a.legends.push_back(l);
  TextStyle wrapped;
  wrapped.size = 12, wrapped.wrap = 300;
  const auto begin = std::chrono::steady_clock::now();
  const int width = legend_room(a, image.width, image.height).right;
  CHECK(width > 0);
  CHECK(width < image.width / 2);
  CHECK(Overlay(640, 400, false).measure(std::string(20000, 'y'), wrapped).lines > 10);
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < 4);
}

TEST_CASE("annotate: sides of the patient at the edges of the picture, free of title and legends") {
  const Box3 box{{-1, -1, -1}, {1, 1, 1}};
  const auto sides_from = [&](Vec3 towards_viewer, Vec3 up) {
    Projection p = look(towards_viewer, box, 200, 150);
    p.right = normalize(cross(p.forward, up)), p.up = cross(p.right, p.forward);
    const PatientSides s = patient_sides(p);
    return s.left + "|" + s.right + "|" + s.top + "|" + s.bottom;
  };
  CHECK(sides_from({0, -1, 0}, {0, 0, 1}) == "R|L|S|I");   // coronal, from the front
  CHECK(sides_from({0, 0, -1}, {0, -1, 0}) == "R|L|A|P");  // axial, from the feet
  CHECK(sides_from({1, 0, 0}, {0, 0, 1}) == "A|P|S|I");    // sagittal, from the patient's left
  CHECK(sides_from({1, -1, 0}, {0, 0, 1}) == "RA|LP|S|I");

  // 400 x 300: letters in the middle of the edges, nothing else.
  Annotation a;
  a.triad = false, a.patient_letters = true;
  const Projection p = look({0, -1, 0}, box, 400, 300);
  Image image = blank(400, 300);
  annotate(image, a, p);
  const auto ink = [&](int x0, int y0, int x1, int y1) {
    int n = 0;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) n += image.pixels[3 * (size_t(y) * 400 + size_t(x))] < 128;
    return n;
  };
  const int left = ink(0, 130, 30, 170), right = ink(370, 130, 400, 170), top = ink(185, 0, 215, 30), bottom = ink(185, 270, 215, 300);
  CHECK(left > 5);
  CHECK(right > 5);
  CHECK(top > 5);
  CHECK(bottom > 5);
  CHECK(ink(0, 0, 400, 300) == left + right + top + bottom);
}
