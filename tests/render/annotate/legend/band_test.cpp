// SPDX-License-Identifier: Apache-2.0
// Legends at all four sides of a picture; bars that lie.
#include "render/annotate/legend/band.h"

#include <fmt/core.h>

#include <cstring>
#include <tuple>

#include "render/annotate/annotate.h"
#include "render/annotate/legend/legend.h"
#include "support/test.h"

using namespace sg;

namespace {

Legend scale_at(LegendPlace place = LegendPlace::bottom) {
  Legend s;
  s.map = find_colormap("sight");
  s.lo = -3, s.hi = 1273, s.title = "pressure", s.unit = "Pa";
  s.place = place;
  return s;
}

Legend parts(int n, LegendPlace place = LegendPlace::bottom) {
  Legend s;
  s.map = find_colormap("labels");
  s.title = "part", s.place = place;
  for (int i = 0; i < n; ++i)
    s.labels.push_back(2 * i), s.label_names.push_back(i % 5 == 4 ? "a part with a longer name" : fmt::format("part {}", i));
  return s;
}

Image white(int width, int height) {
  Image image(width, height, 3);
  std::fill(image.pixels.begin(), image.pixels.end(), uint8_t(255));
  return image;
}

struct Sides {
  Image image;
  std::vector<LegendLayout> layouts;
};

Sides drawn(const std::vector<Legend>& legends, int width = 1280, int height = 720, bool nan = false, double font = 15) {
  Sides d{white(width, height), {}};
  Overlay overlay(width, height, false);
  d.layouts = layout_legends(overlay, legends, {0, 0, double(width), double(height)}, font, nan);
  REQUIRE(d.layouts.size() == legends.size());
  for (size_t i = 0; i < legends.size(); ++i) draw_legend(d.image, overlay, legends[i], d.layouts[i]);
  overlay.put_on(d.image);
  return d;
}

bool has_color(const uint8_t* p, Vec4f c) {
  for (int k = 0; k < 3; ++k)
    if (p[k] != int(255 * c[k] + 0.5f)) return false;
  return true;
}

// Pixels with ink outside of a rectangle.
size_t ink_outside(const Image& image, const Rect& r) {
  size_t n = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (x < r.x || y < r.y || x >= r.right() || y >= r.bottom()) n += image.at(x, y)[0] + image.at(x, y)[1] + image.at(x, y)[2] < 765;
  return n;
}

double text_width(const std::string& text, double font) {
  TextStyle style;
  style.size = font;
  return Overlay(1, 1, false).measure(text, style).width;
}

Projection of_size(int width, int height) {
  Camera camera;
  camera.position = {0, 0, 10}, camera.target = {}, camera.up = {0, 1, 0};
  return make_projection(camera, width, height);
}

}  // namespace

TEST_CASE("lying legends: the column of every number has exactly its colour, low values at the left") {
  for (const LegendPlace place : {LegendPlace::top, LegendPlace::bottom})
    for (const ScaleKind kind : {ScaleKind::linear, ScaleKind::log, ScaleKind::symlog})
      for (const bool reversed : {false, true}) {
        Legend s = scale_at(place);
        s.kind = kind;
        if (kind == ScaleKind::log) s.lo = 0.03;
        if (kind == ScaleKind::symlog) s.lo = -1000, s.linear_threshold = 1;
        if (reversed) std::swap(s.lo, s.hi);
        const Sides d = drawn({s});
        const LegendLayout& l = d.layouts[0];
        CHECK(l.lies());
        REQUIRE(l.ticks.size() >= 3);
        for (const auto& t : l.ticks) {
          CAPTURE(t.text);
          CHECK(has_color(d.image.at(t.row, int(l.bar.y) + 3), s.color(t.value)));
          CHECK(t.row == int(l.bar.x + std::lround(s.position(t.value) * (l.bar.width - 1))));
        }
        // Numbers stay apart.
        for (size_t i = 0; i < l.ticks.size(); ++i)
          for (size_t k = 0; k < i; ++k)
            CHECK(std::abs(l.ticks[i].row - l.ticks[k].row) >
                  0.5 * (text_width(l.ticks[i].text, l.font) + text_width(l.ticks[k].text, l.font)) + 0.5 * l.font);
      }
}

TEST_CASE("legends: a bar is as long as its share of the picture, above or below the picture or beside it") {
  for (const double share : {0.2, 0.5, 0.7}) {
    Legend lying = scale_at(), standing = scale_at(LegendPlace::left);
    lying.bar = standing.bar = share;
    lying.above = Vec3f{1, 0, 0}, standing.below = Vec3f{1, 0, 0};
    CHECK(drawn({lying}).layouts[0].bar.width == doctest::Approx(share * 1280).epsilon(0.002));
    CHECK(drawn({standing}).layouts[0].bar.height == doctest::Approx(share * 720).epsilon(0.004));
    CHECK(drawn({standing}, 1280, 720, true).layouts[0].bar.height == doctest::Approx(share * 720).epsilon(0.004));
  }
  // As long as there is room for.
  for (const LegendPlace place : {LegendPlace::right, LegendPlace::left, LegendPlace::top, LegendPlace::bottom}) {
    Legend s = scale_at(place);
    s.bar = 1;
    const LegendLayout l = drawn({s}).layouts[0];
    const double length = l.lies() ? l.bar.width / 1280 : l.bar.height / 720;
    CHECK(length > 0.85);
    CHECK(length < 0.99);
  }
}

TEST_CASE("legends: at each side they stay within the room that legend_room tells, and inside the picture") {
  using enum LegendPlace;
  const auto all_at = [](LegendPlace place) {
    std::vector<Legend> legends = {scale_at(place), scale_at(place), parts(9, place)};
    legends[0].above = legends[0].below = Vec3f{1, 0, 0};
    legends[1].title = "turbulent_kinetic_energy_dissipation_rate", legends[1].unit = "m\u00b2/s\u00b3";
    legends[1].volume = VolumeLegend{{{{-3, 0}, {1273, 0.4}}}, {}, legends[1], ""};
    legends[0].glyph = GlyphLegend{1, false, true, 12, "m/s", 25};
    return legends;
  };
  for (const LegendPlace place : {right, left, top, bottom})
    for (const auto& [w, h] : {std::pair{1280, 720}, {1920, 1080}, {640, 480}, {480, 640}}) {
      CAPTURE(std::string(word_of(place)));
      CAPTURE(w);
      Annotation a;
      a.triad = false, a.show_nan_in_legend = true, a.legends = all_at(place);
      const LegendRoom room = legend_room(a, w, h);
      const int here = place == right ? room.right : place == left ? room.left : place == top ? room.top : room.bottom;
      CHECK(here > 20);
      CHECK(room.left + room.right + room.top + room.bottom == here);
      Image image = white(w, h);
      annotate(image, a, of_size(w, h));
      const Rect beside{double(room.left), double(room.top), double(w - room.left - room.right), double(h - room.top - room.bottom)};
      size_t inside = 0, border = 0;
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
          const bool ink = image.at(x, y)[0] + image.at(x, y)[1] + image.at(x, y)[2] < 765;
          inside += ink && x >= beside.x && y >= beside.y && x < beside.right() && y < beside.bottom();
          border += ink && (x == 0 || y == 0 || x == w - 1 || y == h - 1);
        }
      CHECK(inside == 0);
      CHECK(border == 0);
      CHECK(ink_outside(image, beside) > 1000);
    }
}

TEST_CASE("legends: title, legends at all sides and a caption keep clear of each other") {
  using enum LegendPlace;
  Annotation a;
  a.triad = false, a.title = "A title above all", a.caption = "A caption below all";
  a.legends = {scale_at(right), scale_at(left), scale_at(top), parts(4, bottom)};
  const int w = 1280, h = 720;
  const LegendRoom room = legend_room(a, w, h);
  const Rect area = area_beside(a, w, h);
  CHECK(area.x == room.left);
  CHECK(area.y == room.top);
  CHECK(area.right() == w - room.right);
  CHECK(area.bottom() == h - room.bottom);
  CHECK(area.width > 0.6 * w);
  CHECK(area.height > 0.5 * h);
  // With either text left out the legends move up or down into its place.
  Annotation less = a;
  less.title.clear();
  CHECK(legend_room(less, w, h).top < room.top);
  less = a, less.caption.clear();
  CHECK(legend_room(less, w, h).bottom < room.bottom);
  // Annotations of the picture itself begin at its corner: letters are as large in both of each pair of sizes.
  for (const auto& [alone_w, alone_h, whole_w, whole_h, x, y] : {std::tuple{700, 600, 700, 720, 0, 100}, {800, 400, 1000, 400, 150, 0}}) {
    Annotation plain;
    plain.patient_letters = true, plain.box = Box3{{-1, -1, -1}, {1, 1, 1}};
    Image alone = white(alone_w, alone_h), whole = white(whole_w, whole_h);
    annotate(alone, plain, of_size(alone_w, alone_h));
    annotate(whole, plain, of_size(alone_w, alone_h), x, y);
    int differ = 0;
    for (int row = 0; row < alone_h; ++row) differ += std::memcmp(alone.at(0, row), whole.at(x, y + row), size_t(alone_w) * 3) != 0;
    CHECK(differ == 0);
    CHECK(ink_outside(alone, {}) > 300);
    CHECK(ink_outside(whole, {double(x), double(y), double(alone_w), double(alone_h)}) == 0);
  }
}

TEST_CASE("lying legends: names stand in rows, each beside a swatch of its colour, with NaN as the last one") {
  for (const int n : {3, 14, 200}) {
    CAPTURE(n);
    const Legend s = parts(n);
    const Sides d = drawn({s}, 1280, 720, true);
    const LegendLayout& l = d.layouts[0];
    CHECK(l.across > 1);
    CHECK(l.column.height < 0.5 * 720);
    CHECK(l.swatches + (size_t(n) > l.swatches) == l.rows.size());
    for (size_t i = 0; i < l.swatches; ++i) {
      const double x = l.bar.x + double(i % l.across) * l.row_width, y = l.bar.y + (double(i / l.across) + 0.5) * l.row_height;
      CHECK(has_color(d.image.at(int(x) + 4, int(y)), s.color(s.labels[i])));
      CHECK(x + l.bar.width + 0.6 * l.font + l.label_width <= l.column.right() + 1);
      CHECK(y + 0.5 * l.row_height <= l.column.bottom() + 1);
    }
    CHECK(has_color(d.image.at(int(l.nan_at.x) + 4, int(l.nan_at.y + 0.5 * l.row_height)), s.color(NAN)));
    CHECK(l.nan_at.y + l.row_height <= l.column.bottom() + 1);
  }
  // A narrower list has more rows.
  Legend wide = parts(14), narrow = parts(14);
  wide.bar = 0.9, narrow.bar = 0.3;
  CHECK(drawn({narrow}).layouts[0].across < drawn({wide}).layouts[0].across);
  CHECK(drawn({narrow}).layouts[0].column.width <= 0.3 * 1280 + 15);
}

TEST_CASE("lying legends: bands show their limits, and fewer where they have no room") {
  Legend s = scale_at();
  s.labels = {0, 1, 2}, s.limits = {988, 992, 996, 1000};
  const Sides d = drawn({s});
  const LegendLayout& l = d.layouts[0];
  REQUIRE(l.ticks.size() == 4);
  CHECK(l.ticks[0].text == "988");
  CHECK(l.ticks[0].row == int(l.bar.x));
  CHECK(l.ticks[3].row == int(l.bar.right()) - 1);
  for (int band = 0; band < 3; ++band)
    CHECK(has_color(d.image.at(int(l.bar.x + (band + 0.5) / 3 * l.bar.width), int(l.bar.y) + 3), s.color(band)));
  s.limits = {100000, 100001, 100002, 100003}, s.bar = 0.1;
  CHECK(drawn({s}).layouts[0].ticks.size() < 4);
}

TEST_CASE("lying legends: a volume's opacity stands above the bar, in exactly the colours of its columns") {
  Legend s = scale_at();
  s.lo = 0, s.hi = 100;
  s.volume = VolumeLegend{{{{0, 0}, {50, 0}, {50, 0.2}, {100, 0.4}}}, {}, s, ""};
  const Sides d = drawn({s});
  const LegendLayout& l = d.layouts[0];
  REQUIRE(l.panel.height > 40);
  CHECK(l.panel.bottom() < l.bar.y);
  CHECK(l.panel.x == l.bar.x);
  CHECK(l.panel.width == l.bar.width);
  CHECK(l.panel_right == "0.4");
  const int bottom = int(l.panel.bottom()) - 1, last = int(l.panel.height) - 1, n = int(l.bar.width);
  for (int i = 2; i < n - 2; i += 7) {
    const int x = int(l.bar.x) + i;
    const double value = s.value_at(double(i) / (n - 1));
    const int reach = int(std::lround(s.volume->opacity.at(value) / 0.4 * last));
    if (reach > 6) CHECK(has_color(d.image.at(x, bottom - reach / 2), s.color(value)));
    const uint8_t* ground = d.image.at(x, bottom - reach - 4);
    if (reach < last - 8) CHECK((ground[0] == ground[1] && ground[1] == ground[2] && ground[0] > 210));
  }
}

TEST_CASE("lying legends: two side by side where there is room, else one above the other") {
  Legend s = scale_at(), t = scale_at();
  s.bar = t.bar = 0.3;
  const auto beside = drawn({s, t}).layouts;
  CHECK(beside[0].bar.y == beside[1].bar.y);
  CHECK(beside[0].column.right() + 15 <= beside[1].column.x);
  s.bar = t.bar = 0.7;
  const auto below = drawn({s, t}).layouts;
  CHECK(below[0].column.bottom() <= below[1].column.y);
  CHECK(below[0].bar.x == below[1].bar.x);
}

TEST_CASE("legends: thumbnails get small ones at any side, or none, but never a cropped one") {
  using enum LegendPlace;
  for (const LegendPlace place : {right, left, top, bottom})
    for (const auto& [w, h] : {std::pair{160, 120}, {60, 200}, {200, 60}, {24, 24}, {2, 2}}) {
      const Overlay overlay(1, 1, false);
      Legend volume = scale_at(place);
      volume.volume = VolumeLegend{{{{-3, 0}, {1273, 0.4}}}, {}, volume, ""};
      for (const LegendLayout& l : layout_legends(overlay, {volume, parts(30, place)}, {0, 0, double(w), double(h)}, 9, true)) {
        CHECK(l.column.x >= 0);
        CHECK(l.column.y >= 0);
        CHECK(l.column.right() <= w);
        CHECK(l.column.bottom() <= h);
      }
    }
}

TEST_CASE("legends: as many numbers as are stated, round ones where a step gives so many, else from end to end") {
  const auto numbers = [](double lo, double hi, int count) {
    Legend s = scale_at(LegendPlace::right);
    s.lo = lo, s.hi = hi, s.tick_count = count;
    std::vector<double> values;
    const Sides sides = drawn({s});
    for (const LegendLayout::Tick& t : sides.layouts[0].ticks) values.push_back(t.value);
    std::sort(values.begin(), values.end());
    return values;
  };
  CHECK(numbers(0, 100, 5) == std::vector<double>{0, 25, 50, 75, 100});
  CHECK(numbers(0, 10, 6) == std::vector<double>{0, 2, 4, 6, 8, 10});
  CHECK(numbers(293, 913, 3) == std::vector<double>{400, 600, 800});
  CHECK(numbers(293, 913, 5) == std::vector<double>{300, 450, 600, 750, 900});
  CHECK(numbers(293, 913, 4) == std::vector<double>{293, 293 + 620.0 / 3, 293 + 2 * 620.0 / 3, 913});
  CHECK(numbers(293, 913, 2).size() == 2);
  for (int count = 1; count <= 12; ++count) CHECK(numbers(-3, 1273, count).size() == size_t(count));
}
