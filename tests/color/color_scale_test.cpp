// SPDX-License-Identifier: Apache-2.0
#include "color/color_scale.h"

#include <set>

#include "color/cie.h"
#include "support/test.h"

using namespace sg;

namespace {

const double nan_value = std::numeric_limits<double>::quiet_NaN();

ColorScale red_to_blue(double lo, double hi, ScaleKind kind = ScaleKind::linear) {
  ColorScale s;
  s.map = {"rb", MapKind::sequential, "", {{1, 0, 0}, {0, 0, 1}}};
  s.lo = lo, s.hi = hi, s.kind = kind;
  return s;
}

}  // namespace

TEST_CASE("colour scale: positions hit 0 and 1 at the ends and invert") {
  struct Case {
    double lo, hi;
    ScaleKind kind;
    double threshold;
  };
  for (const Case& c :
       {Case{-3, 7, ScaleKind::linear, 0}, Case{7, -3, ScaleKind::linear, 0}, Case{1e-5, 3e4, ScaleKind::log, 0},
        Case{-50, 2000, ScaleKind::symlog, 0.1}, Case{-1, 1, ScaleKind::symlog, 0}, Case{-1e308, 1.7e308, ScaleKind::linear, 0}}) {
    ColorScale s = red_to_blue(c.lo, c.hi, c.kind);
    s.linear_threshold = c.threshold;
    CHECK(s.position(c.lo) == 0);
    CHECK(s.position(c.hi) == 1);
    CHECK(s.value_at(0) == c.lo);
    CHECK(s.value_at(1) == c.hi);
    double last = -1;
    for (int i = 0; i <= 100; ++i) {
      const double t = s.position(s.value_at(i / 100.0));
      CHECK(t == doctest::Approx(i / 100.0).epsilon(1e-9).scale(1));
      CHECK(t > last);
      last = t;
    }
  }
}

TEST_CASE("colour scale: the middle of a log range is the geometric mean; symlog is odd about zero") {
  CHECK(red_to_blue(1, 10000, ScaleKind::log).position(100) == doctest::Approx(0.5));
  ColorScale s = red_to_blue(-1000, 1000, ScaleKind::symlog);
  s.linear_threshold = 1;
  CHECK(s.position(0) == 0.5);
  CHECK(s.position(-10) == doctest::Approx(1 - s.position(10)));
  CHECK(s.position(10) == doctest::Approx(0.5 + 0.5 * 2 / 4));  // 1 linear + 1 decade of 1 + 3
}

TEST_CASE("colour scale: below, above and NaN") {
  ColorScale s = red_to_blue(0, 1);
  s.nan = {0.5f, 0.25f, 0};
  CHECK(s.color(-5) == Vec4f{1, 0, 0, 1});
  CHECK(s.color(5) == Vec4f{0, 0, 1, 1});
  CHECK(s.color(nan_value) == Vec4f{0.5f, 0.25f, 0, 1});
  CHECK(s.color(0.25) == Vec4f{0.75f, 0, 0.25f, 1});
  s.below = Vec3f{0, 1, 0};
  s.above = Vec3f{1, 1, 0};
  CHECK(s.color(-1e-9) == Vec4f{0, 1, 0, 1});
  CHECK(s.color(HUGE_VAL) == Vec4f{1, 1, 0, 1});
  CHECK(s.color(0) == Vec4f{1, 0, 0, 1});
  s.clamp = false;
  CHECK(s.color(-1).w == 0);
  CHECK(s.color(1.1).w == 0);
  CHECK(s.color(1).w == 1);
  const ColorTable table = color_table(s, 256);
  CHECK(table.linear.size() == 256);
  CHECK(table.at(s.position(-1)).w == 0);
  CHECK(table.at(s.position(nan_value)).y == doctest::Approx(srgb_to_linear(0.25)));
  CHECK(red_to_blue(1, 10, ScaleKind::log).position(0) < 0);
  CHECK(red_to_blue(1, 10, ScaleKind::log).position(-1) < 0);
}

TEST_CASE("colour scale: a range of one value puts it in the middle") {
  for (ScaleKind kind : {ScaleKind::linear, ScaleKind::log, ScaleKind::symlog}) {
    const ColorScale s = red_to_blue(3, 3, kind);
    CHECK(s.position(3) == 0.5);
    CHECK(s.position(2) < 0);
    CHECK(s.position(4) > 1);
  }
}

TEST_CASE("colour scale: labels take the colour of their place, other values the NaN colour") {
  ColorScale s;
  s.map = {"c", MapKind::categorical, "", {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  s.labels = {7, 0.1, 300, 12};  // one more than the map has
  const ColorTable table = color_table(s, 2);
  for (size_t i = 0; i < 4; ++i) {
    const Vec3f c = s.map.colors[i % 3];
    CHECK(s.color(s.labels[i]) == Vec4f{c.x, c.y, c.z, 1});
    CHECK(table.at(s.position(s.labels[i])) == Vec4f{c.x, c.y, c.z, 1});
    CHECK(s.value_at(s.position(s.labels[i])) == s.labels[i]);
  }
  CHECK(s.position(double(0.1f)) == s.position(0.1));
  CHECK(std::isnan(s.position(8)));
  CHECK(s.color(8) == Vec4f{s.nan.x, s.nan.y, s.nan.z, 1});
  // A continuous map is spread over the labels.
  s.map = {"rb", MapKind::sequential, "", {{1, 0, 0}, {0, 0, 1}}};
  CHECK(s.color(7) == Vec4f{1, 0, 0, 1});
  CHECK(s.color(12) == Vec4f{0, 0, 1, 1});
}

TEST_CASE("colour scale: the table holds linear light") {
  const ColorScale s = red_to_blue(0, 10);
  const ColorTable t = color_table(s);
  CHECK(t.linear.size() == 4096);
  CHECK(t.at(0) == Vec4f{1, 0, 0, 1});
  CHECK(t.at(1) == Vec4f{0, 0, 1, 1});
  CHECK(t.at(0.5).x == doctest::Approx(0.21404).epsilon(1e-3));
  CHECK(t.at(-0.1) == Vec4f{1, 0, 0, 1});
}

TEST_CASE("colour scale: a log scale needs a positive range") {
  CHECK(test::error_of([] { color_table(red_to_blue(0, 1, ScaleKind::log)); }).find("symlog") != std::string::npos);
  ColorScale s = red_to_blue(1, 100, ScaleKind::log);
  for (const double v : {0.0, -3.0, -HUGE_VAL}) CHECK(s.color(v) == s.color(0.5));  // below every decade
  CHECK(s.color(nan_value) == Vec4f{s.nan.x, s.nan.y, s.nan.z, 1});
  std::swap(s.lo, s.hi);
  CHECK(s.color(0) == s.color(0.5));
}

TEST_CASE("opacity curve: linear between points, constant beyond, steps, largest over an interval") {
  const OpacityCurve c = parse_opacity("0:0, 0.5:0.8, 0.5:0.2, 1:1", 100, 200);
  CHECK(c.at(0) == 0);
  CHECK(c.at(125) == doctest::Approx(0.4));
  CHECK(c.at(150) == 0.2);
  CHECK(c.at(149.999999) == doctest::Approx(0.8));
  CHECK(c.at(300) == 1);
  CHECK(c.most(0, 120) == c.at(120));
  CHECK(c.most(140, 160) == 0.8);
  CHECK(c.most(160, 140) == 0.8);
  CHECK(c.at(nan_value) == 0);
  CHECK(parse_opacity("0.3", 0, 1).at(17) == 0.3);
  CHECK(parse_opacity("@300:1,@400:0", 0, 1).at(350) == 0.5);
}

TEST_CASE("opacity curve: mistakes are named") {
  CHECK(test::error_of([] { parse_opacity("", 0, 1); }).find("empty") != std::string::npos);
  CHECK(test::error_of([] { parse_opacity("0:0,1", 0, 1); }).find("'1' is not a point") != std::string::npos);
  CHECK(test::error_of([] { parse_opacity("0:0,x:1", 0, 1); }).find("'x:1'") != std::string::npos);
  CHECK(test::error_of([] { parse_opacity("0:0,1:1.5", 0, 1); }).find("1.5 is not between 0 and 1") != std::string::npos);
  CHECK(test::error_of([] { parse_opacity("0:0,nan:1", 0, 1); }).find("nan:1") != std::string::npos);
}

namespace {

std::string texts(const std::vector<TickLabel>& ticks) {
  std::string all;
  for (const TickLabel& t : ticks) all += (all.empty() ? "" : " ") + t.text;
  return all;
}

}  // namespace

TEST_CASE("ticks: round steps") {
  CHECK(texts(nice_ticks(0, 1, 5)) == "0.0 0.2 0.4 0.6 0.8 1.0");
  CHECK(texts(nice_ticks(-0.1, 0.1, 5)) == "-0.10 -0.05 0.00 0.05 0.10");
  CHECK(texts(nice_ticks(13, 977, 5)) == "200 400 600 800");
  CHECK(texts(nice_ticks(977, 13, 5)) == "200 400 600 800");
  CHECK(texts(nice_ticks(1e-7, 5e-7, 5)) == "1e-7 2e-7 3e-7 4e-7 5e-7");
  CHECK(texts(nice_ticks(4, 4, 5)) == "4");
  CHECK(nice_ticks(nan_value, 1, 5).empty());
}

TEST_CASE("ticks: within the range, distinct texts that read back, no minus zero, about as many as wanted") {
  for (double offset : {0.0, -1.0, 1.0, 300.0, -1e7, 1e7, 1e12, 6.02e23})
    for (double range : {1e-30, 1e-9, 1e-6, 0.01, 1.0, 3.3, 777.0, 1e9, 1e25})
      for (int wanted : {2, 4, 5, 8, 12}) {
        const double lo = offset - 0.37 * range, hi = lo + range;
        const auto ticks = nice_ticks(lo, hi, wanted);
        INFO(lo << " " << hi << " " << wanted << ": " << texts(ticks));
        if (lo == hi) {
          CHECK(ticks.size() == 1);
          continue;
        }
        CHECK(ticks.size() >= 2);
        CHECK(ticks.size() <= size_t(2 * wanted + 1));
        std::set<std::string> seen;
        for (const TickLabel& t : ticks) {
          CHECK(t.value >= lo);
          CHECK(t.value <= hi);
          CHECK(seen.insert(t.text).second);
          CHECK(!(t.text[0] == '-' && std::stod(t.text) == 0));
          CHECK(std::stod(t.text) == doctest::Approx(t.value).epsilon(1e-14).scale(1e-3 * (hi - lo)));
        }
      }
}

TEST_CASE("ticks: decades on a log scale, both sides on a symlog scale") {
  CHECK(texts(nice_ticks(1e-3, 1e3, 7, ScaleKind::log)) == "0.001 0.01 0.1 1 10 100 1000");
  CHECK(texts(nice_ticks(1e-12, 1e12, 5, ScaleKind::log)) == "1e-10 1e-5 1 1e5 1e10");
  CHECK(texts(nice_ticks(1, 100, 6, ScaleKind::log)) == "1 2 5 10 20 50 100");
  CHECK(nice_ticks(2.1, 2.9, 5, ScaleKind::log).size() >= 3);
  CHECK(nice_ticks(-1, 1, 5, ScaleKind::log).empty());
  CHECK(texts(nice_ticks(-1000, 1000, 9, ScaleKind::symlog, 1)) == "-1000 -100 -10 -1 0 1 10 100 1000");
  CHECK(texts(nice_ticks(-1000, 1000, 5, ScaleKind::symlog, 1)) == "-1000 -10 0 10 1000");
  CHECK(texts(nice_ticks(-0.5, 0.5, 5, ScaleKind::symlog, 1)) == "-0.4 -0.2 0.0 0.2 0.4");
}
