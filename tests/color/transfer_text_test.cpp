// SPDX-License-Identifier: Apache-2.0
#include "color/transfer_text.h"

#include "color/parse_color.h"
#include "support/test.h"

using namespace sg;
using test::contains;

namespace {

ColorScale axis(double lo, double hi, ScaleKind kind = ScaleKind::linear) {
  ColorScale s;
  s.map = find_colormap("sight");
  s.lo = lo, s.hi = hi, s.kind = kind;
  return s;
}

}  // namespace

TEST_CASE("opacity: positions and values may be mixed, and text reads back exactly") {
  const OpacityCurve c = parse_opacity("0:0, @-500:0.1, @200:0.4, 1:0.8", axis(-1000, 3000));
  REQUIRE(c.points.size() == 4);
  CHECK(c.points[0] == Vec2{-1000, 0});
  CHECK(c.points[1] == Vec2{-500, 0.1});
  CHECK(c.points[2] == Vec2{200, 0.4});
  CHECK(c.points[3] == Vec2{3000, 0.8});
  const std::string text = opacity_text(c);
  CHECK(parse_opacity(text, axis(7, 9)).points == c.points);  // whatever the range
  CHECK(opacity_text(parse_opacity(text, axis(0, 1))) == text);
}

TEST_CASE("opacity: on a log scale positions are along the scale and lines straight on it") {
  const OpacityCurve c = parse_opacity("0:0,1:1", axis(1, 10000, ScaleKind::log));
  CHECK(c.at(100) == doctest::Approx(0.5));
  CHECK(c.at(10) == doctest::Approx(0.25));
  CHECK(parse_opacity("0.5:0.3", axis(1, 10000, ScaleKind::log)).points[0].x == doctest::Approx(100));
  const OpacityCurve values = parse_opacity("@1:0,@10000:1", axis(1, 10000, ScaleKind::log));
  CHECK(values.points.size() == 2);
  CHECK(parse_opacity(opacity_text(c), axis(1, 10000, ScaleKind::log)).points == c.points);
}

TEST_CASE("opacity: curves that cannot be are refused with what would be right") {
  const ColorScale a = axis(0, 10);
  CHECK(contains(test::error_of([&] { parse_opacity("0:0,0.6:0.5,0.3:1", a); }), "'0.3:1' lies below the previous point"));
  CHECK(contains(test::error_of([&] { parse_opacity("0:0,0.6:0.5,@3:1", a); }), "ascending"));
  CHECK(contains(test::error_of([&] { parse_opacity("0:0,0.5:0,0.5:1,0.5:0", a); }), "third point"));
  CHECK(contains(test::error_of([&] { parse_opacity(" ", a); }), "empty"));
  CHECK(contains(test::error_of([&] { parse_opacity("0:0,1:1.01", a); }), "1.01 is not between 0 and 1"));
  CHECK(contains(test::error_of([&] { parse_opacity("0:-0.1", a); }), "not between 0 and 1"));
  CHECK(contains(test::error_of([&] { parse_opacity("0:nan", a); }), "not between 0 and 1"));
  CHECK(contains(test::error_of([&] { parse_opacity("0:0,200:0.5", a); }), "a value is written with @: @200"));
  CHECK(contains(test::error_of([&] { parse_opacity("-1:0,1:0.5", a); }), "position -1 is not between 0 and 1"));
  CHECK(contains(test::error_of([&] { parse_opacity("@inf:1", a); }), "'@inf:1' is not a point"));
  CHECK(contains(test::error_of([&] { parse_opacity("@:1", a); }), "is not a point"));
  CHECK(contains(test::error_of([&] { parse_opacity("@-1:0,1:1", axis(1, 10, ScaleKind::log)); }), "log scale"));
  CHECK(contains(test::error_of([&] { parse_opacity("0:2", a, "second_opacity"); }), "second_opacity"));
}

TEST_CASE("colour stops: the scale goes from the first to the last, with its colours exactly there") {
  ColorScale s = axis(0, 100);
  parse_color_stops("0.1:#000000,@40:#aa3311,1:white", s, false);
  CHECK(s.lo == 10);
  CHECK(s.hi == 100);
  CHECK(color_text({s.color(10).x, s.color(10).y, s.color(10).z}) == "#000000");
  CHECK(s.color(40).x == doctest::Approx(0xaa / 255.0).epsilon(0.01));
  CHECK(s.color(70).y == doctest::Approx(0.5 * (0x33 / 255.0 + 1)).epsilon(0.01));
  CHECK(color_text({s.color(100).x, s.color(100).y, s.color(100).z}) == "#ffffff");
  // A stated range stays; the end colours go on.
  ColorScale kept = axis(0, 100);
  parse_color_stops("@40:black,@60:white", kept, true);
  CHECK(kept.lo == 0);
  CHECK(kept.hi == 100);
  CHECK(kept.color(20).x == 0);
  CHECK(kept.color(50).x == doctest::Approx(0.5).epsilon(0.02));
  CHECK(kept.color(90).x == 1);
  ColorScale wide = axis(0, 100);
  parse_color_stops("@-100:black,@100:white", wide, true);
  CHECK(wide.color(0).x == doctest::Approx(0.5));
  // Numbers for colours, and steps.
  ColorScale step = axis(0, 1);
  parse_color_stops("0:1,0,0,0.5:1,0,0,0.5:0,0,1,1:0,0,1", step, false);
  CHECK(step.color(0.3).x == 1);
  CHECK(step.color(0.7).z == 1);
  CHECK(step.color(0.7).x == 0);
  ColorScale one = axis(0, 1);
  parse_color_stops("0.5:tomato", one, false);
  CHECK(one.color(0).x == 1);
  CHECK(one.lo == 0);
}

TEST_CASE("colour stops: text of a map reads back within half a step of 8 bits") {
  ColorScale s = axis(-3, 12);
  const std::string text = color_stops_text(s);
  ColorScale again = axis(0, 1);
  parse_color_stops(text, again, false);
  CHECK(again.lo == -3);
  CHECK(again.hi == 12);
  for (int i = 0; i <= 100; ++i) {
    const double v = -3 + 0.15 * i;
    for (int k = 0; k < 3; ++k) CHECK(std::abs(again.color(v)[k] - s.color(v)[k]) < 1.6 / 255);
  }
  ColorScale third = axis(0, 1);
  parse_color_stops(color_stops_text(again), third, false);
  CHECK(third.lo == -3);
}

TEST_CASE("colour stops: mistakes are named") {
  ColorScale s = axis(0, 1);
  const auto error = [&](const char* text) { return test::error_of([&] { parse_color_stops(text, s, false); }); };
  CHECK(contains(error(""), "no colours"));
  CHECK(contains(error("0:black,1"), "'black,1' is not a colour"));
  CHECK(contains(error("black"), "'black' is not a colour at a position"));
  CHECK(contains(error("0.5:black,0.2:white"), "ascending"));
  CHECK(contains(error("0:blakc,1:white"), "did you mean 'black'"));
  CHECK(contains(error("x:black"), "'x:black'"));
  CHECK(contains(error("0:black,0:white,0:red"), "third colour"));
}
