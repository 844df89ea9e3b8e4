// SPDX-License-Identifier: Apache-2.0
#include "color/widgets/widgets_text.h"

#include <string>
#include <vector>

#include "color/parse_color.h"
#include "color/widgets/random_widgets.h"
#include "support/test.h"

using namespace sg;
using test::contains;

namespace {

ColorScale axis(double lo, double hi, ScaleKind kind = ScaleKind::linear) {
  ColorScale s;
  s.lo = lo, s.hi = hi, s.kind = kind;
  return s;
}

}  // namespace

TEST_CASE("widgets: places on both axes, and text reads back exactly") {
  const ColorScale value = axis(-1000, 3000), second = axis(0, 500);
  const auto w = parse_widgets("triangle 0.25 @400 0 1 0.6 tomato; rectangle @0 @100 0.1 @300;", value, second);
  REQUIRE(w.size() == 2);
  CHECK(w[0].shape == TransferWidget::Shape::triangle);
  CHECK(w[0].lo == 0);
  CHECK(w[0].hi == 400);
  CHECK(w[0].second_hi == 500);
  CHECK(w[0].opacity == 0.6);
  CHECK(color_text(w[0].color) == "#ff6347");
  CHECK(w[1].second_lo == 50);
  CHECK(w[1].second_hi == 300);
  CHECK(w[1].opacity == 1);
  CHECK(w[1].color.x < 0);  // that of the map
  const std::string text = widgets_text(w);
  CHECK(widgets_text(parse_widgets(text, axis(0, 1), axis(0, 1))) == text);

  const auto error = [&](const char* t) { return test::error_of([&] { parse_widgets(t, value, second); }); };
  CHECK(contains(error("triangel 0 1 0 1"), "did you mean 'triangle'"));
  CHECK(contains(error("triangle 0 1 0"), "3 numbers"));
  CHECK(contains(error("rectangle 0.5 0.2 0 1"), "lower end"));
  CHECK(contains(error("rectangle 0 1 0.5 0.5"), "zero width or height"));
  CHECK(contains(error("rectangle 0 1 0 1 1.5"), "not between 0 and 1"));
  CHECK(contains(error("rectangle 0 x 0 1"), "'x'"));
  CHECK(contains(error(" ; "), "no widgets"));
  CHECK(contains(error("rectangle 0 1 0 1 1 nocolour"), "not a colour"));
}

TEST_CASE("widgets: ellipses and paint, places in either form, radii as shares and lengths") {
  const ColorScale value = axis(-1000, 3000), second = axis(0, 500);
  const auto w =
      parse_widgets("ellipse 0.25 @400 0 1 0.6 tomato; paint 0.05:@30 0.5,@100 @1500,0.5 0.7 1,0,0; paint @7:0.1 0,0;paint 1:1 0,0 1,1 0.5",
                    value, second);
  REQUIRE(w.size() == 4);
  CHECK(w[0].shape == TransferWidget::Shape::ellipse);
  CHECK(w[0].lo == 0);
  CHECK(w[0].hi == 400);
  CHECK(w[0].second_hi == 500);
  CHECK(w[0].opacity == 0.6);
  CHECK(w[1].shape == TransferWidget::Shape::paint);
  CHECK(w[1].radius == 200);
  CHECK(w[1].second_radius == 30);
  REQUIRE(w[1].line.size() == 2);
  CHECK(w[1].line[0] == Vec2{1000, 100});
  CHECK(w[1].line[1] == Vec2{1500, 250});
  CHECK(w[1].lo == 800);
  CHECK(w[1].second_hi == 280);
  CHECK(w[1].opacity == 0.7);
  CHECK(color_text(w[1].color) == "#ff0000");
  CHECK(w[2].line.size() == 1);
  CHECK(w[2].radius == 7);
  CHECK(w[2].second_radius == 50);
  CHECK(w[2].opacity == 1);
  CHECK(w[2].color.x < 0);
  CHECK(w[3].line.size() == 2);
  CHECK(w[3].opacity == 0.5);
  // Positions follow a log scale, radii do not.
  const auto log = parse_widgets("paint 0.1:0.1 0.5,0.5", axis(1, 100, ScaleKind::log), second);
  CHECK(log[0].line[0].x == doctest::Approx(10));
  CHECK(log[0].radius == doctest::Approx(9.9));
}

TEST_CASE("widgets: mistakes in ellipses and paint are named") {
  const auto error = [](const std::string& t) { return test::error_of([&] { parse_widgets(t, axis(0, 1), axis(0, 1)); }); };
  CHECK(contains(error("elipse 0 1 0 1"), "did you mean 'ellipse'"));
  CHECK(contains(error("ellipse 0 1 0"), "3 numbers"));
  CHECK(contains(error("ellipse 0 1 0 1 1 red 2"), "7 numbers"));
  CHECK(contains(error("ellipse 0.5 0.5 0 1"), "zero width or height"));
  CHECK(contains(error("paint"), "radii of a brush"));
  CHECK(contains(error("paint 0.1 0.5,0.5"), "radii of a brush"));
  CHECK(contains(error("paint 0.1:0.1:0.1 0.5,0.5"), "radii of a brush"));
  CHECK(contains(error("paint 0.1:0.1"), "no points"));
  CHECK(contains(error("paint 0.1:0.1 0.7 red"), "no points"));
  CHECK(contains(error("paint 0:0.1 0.5,0.5"), "radius 0"));
  CHECK(contains(error("paint 0.1:-1 0.5,0.5"), "radius -1"));
  CHECK(contains(error("paint 0.1:x 0.5,0.5"), "'x' in"));
  CHECK(contains(error("paint 0.1:0.1 0.5,y"), "'y' in"));
  CHECK(contains(error("paint 0.1:0.1 0.5,0.5 0.5 red 0.3,0.3"), "'0.5' is not a point"));
  CHECK(contains(error("paint 0.1:0.1 0.5,0.5 1.5"), "not between 0 and 1"));
  CHECK(contains(error("paint 0.1:0.1 0.5,0.5 1 nocolour"), "not a colour"));
  std::string many = "paint 0.1:0.1";
  for (int i = 0; i < 256; ++i) many += " 0.5,0.5";
  CHECK(parse_widgets(many, axis(0, 1), axis(0, 1))[0].line.size() == 256);
  CHECK(contains(error(many + " 0.5,0.5"), "257 points"));
}

TEST_CASE("property: widgets of all shapes read back from text as they were") {
  for (uint64_t seed : test::property_seeds(100)) {
    CAPTURE(seed);
    test::Random random(seed);
    std::vector<TransferWidget> all;
    for (int n = random.whole(1, 6); n > 0; --n) all.push_back(test::random_widget(random, {-3, 0}, {5, 1e5}));
    const std::string text = widgets_text(all);
    const auto back = parse_widgets(text, axis(0, 1), axis(7, 9));
    REQUIRE(back.size() == all.size());
    CHECK(widgets_text(back) == text);
    for (size_t i = 0; i < all.size(); ++i) {
      CHECK(back[i].shape == all[i].shape);
      CHECK(back[i].lo == all[i].lo);
      CHECK(back[i].hi == all[i].hi);
      CHECK(back[i].second_lo == all[i].second_lo);
      CHECK(back[i].second_hi == all[i].second_hi);
      CHECK(back[i].line == all[i].line);
      CHECK(back[i].radius == all[i].radius);
      CHECK(back[i].second_radius == all[i].second_radius);
      CHECK(back[i].opacity == all[i].opacity);
    }
  }
}

TEST_CASE("widgets: only data can tell the lower of a position and a value") {
  CHECK(mixes_ends("triangle 0 @-500 0 1"));
  CHECK(mixes_ends("triangle 0 1 0 1; ellipse 0 1 @3 1"));
  CHECK_FALSE(mixes_ends("ellipse @0 @1 0 1 0.5 red"));
  CHECK_FALSE(mixes_ends("paint 0.1:@5 0,0 @5,@7 1"));
}
