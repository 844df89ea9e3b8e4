// SPDX-License-Identifier: Apache-2.0
// Stops of colour stay where they are stated: in text, in files, and about a hinge.
#include <fmt/core.h>

#include "base/text/text.h"
#include "color/map_files/colormap_file.h"
#include "color/map_files/colormap_formats.h"
#include "color/map_files/colormap_nodes.h"
#include "color/parse_color.h"
#include "color/transfer_text.h"
#include "support/test.h"

using namespace sg;

namespace {

const Vec3f red{1, 0, 0}, lime{0, 1, 0}, blue{0, 0, 1}, white{1, 1, 1};

ColorScale stops(const std::string& text, double lo = 0, double hi = 1) {
  ColorScale s;
  s.lo = lo, s.hi = hi;
  parse_color_stops(text, s, false);
  return s;
}
Vec3f at(const ColorScale& s, double v) {
  const Vec4f c = s.color(v);
  return {c.x, c.y, c.z};
}
bool near(Vec3f a, Vec3f b) { return length(a - b) < 1e-5f; }

}  // namespace

TEST_CASE("colour stops: each has its colour at its place, and between two the colour goes straight") {
  for (const double middle : {0.5, 0.495, 0.509, 0.3333333, 0.0007, 0.9994}) {
    INFO(middle);
    const ColorScale s = stops(fmt::format("0:red,{}:#00ff00,1:blue", middle));
    CHECK(near(at(s, middle), lime));
    CHECK(near(at(s, 0.5 * middle), {0.5f, 0.5f, 0}));
    CHECK(near(at(s, 0.25 + 0.75 * middle), {0, 0.75f, 0.25f}));
  }
}

TEST_CASE("colour stops: two at one place make a step exactly there") {
  for (const double step : {0.5, 0.123456789, 0.99999, 1e-9}) {
    INFO(step);
    const ColorScale s = stops(fmt::format("0:red,{0}:red,{0}:blue,1:blue", exact_number(step)));
    CHECK(at(s, std::nextafter(step, 0.0)) == red);
    CHECK(at(s, step) == blue);
    CHECK(at(s, 0) == red);
    CHECK(at(s, 1) == blue);
  }
  const ColorScale log = [] {
    ColorScale s;
    s.lo = 1, s.hi = 1000, s.kind = ScaleKind::log;
    parse_color_stops("@1:red,@30:red,@30:blue,@1000:blue", s, false);
    return s;
  }();
  CHECK(at(log, 29.9999) == red);
  CHECK(at(log, 30.0001) == blue);
}

TEST_CASE("colour stops: text reads back as the same colours") {
  const ColorScale s = stops("@-5:#102030,@1.25:#ff0000,@1.25:#00ff00,@7:#0000ff", -5, 7);
  ColorScale back;
  parse_color_stops(color_stops_text(s), back, false);
  CHECK(back.lo == -5);
  CHECK(back.hi == 7);
  CHECK(back.map.colors == s.map.colors);
  REQUIRE(back.map.positions.size() == 4);
  for (size_t i = 0; i < 4; ++i) CHECK(back.map.positions[i] == doctest::Approx(s.map.positions[i]).epsilon(1e-14));
  CHECK(back.map.positions[1] == back.map.positions[2]);
}

TEST_CASE("colour stops: of a file, too, reversed as well") {
  const FileColormap cpt = parse_cpt("0 255/0/0 3 255/0/0\n3 0/0/255 10 0/0/255\n", "a.cpt");
  CHECK(cpt.map.at(0.2999999) == red);
  CHECK(cpt.map.at(0.3000001) == blue);
  Colormap back = cpt.map;
  reverse(back);
  CHECK(back.at(0.6999999) == blue);
  CHECK(back.at(0.7000001) == red);
  const auto json = parse_json_maps(R"([{"Name":"m","ColorSpace":"Lab","RGBPoints":[0,1,0,0, 0.7,1,0,0, 0.7,0,1,0, 1,1,1,1]}])", "a.json");
  CHECK(near(json[0].map.at(0.6999999), red));
  CHECK(near(json[0].map.at(0.7000001), lime));
  CHECK(json[0].map.at(1) == white);
}

TEST_CASE("colour stops: a hinge is a knot, and each side keeps its stops") {
  FileColormap f = parse_cpt("-4 255/0/0 0 255/255/255\n0 0/255/0 2 0/255/0\n2 0/0/255 4 0/0/255\n", "h.cpt");
  f.hinge = 0;
  const Colormap m = hinged(f, -1, 3);  // 0 lies at a quarter
  CHECK(m.at(0) == red);
  CHECK(near(m.at(0.125), {1, 0.5f, 0.5f}));
  CHECK(near(m.at(0.2499999), white));
  CHECK(m.at(0.2500001) == lime);
  CHECK(m.at(0.6249999) == lime);
  CHECK(m.at(0.6250001) == blue);
}

TEST_CASE("colour scale: its knots are its stops, the borders of bands and ends that cut off, not the samples of a smooth map") {
  CHECK(color_knots(stops("0:red,0.25:#00ff00,0.4:#00ff00,0.4:blue,1:blue", 0, 8)) == std::vector<double>{0, 2, 3.2, 8});
  ColorScale smooth;
  smooth.map = find_colormap("sight"), smooth.lo = -1, smooth.hi = 3;
  CHECK(color_knots(smooth) == std::vector<double>{-1, 3});
  ColorScale bands = smooth;
  bands.map.kind = MapKind::categorical, bands.map.colors = {red, lime, blue, white};
  CHECK(color_knots(bands) == std::vector<double>{-1, 0, 1, 2, 3});
}
