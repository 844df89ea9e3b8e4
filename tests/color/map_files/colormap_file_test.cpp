// SPDX-License-Identifier: Apache-2.0
#include "color/map_files/colormap_file.h"

#include <fmt/core.h>

#include <algorithm>

#include <nlohmann/json.hpp>

#include "base/file/file.h"
#include "base/text/text.h"
#include "color/cie.h"
#include "color/map_files/colormap_nodes.h"
#include "color/parse_color.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using Json = nlohmann::json;

namespace {

std::string temp(const std::string& name, std::string_view text) {
  const std::string path = test::temp_folder() + name;
  write_file(path, text);
  return path;
}
FileColormap one(const std::string& name, std::string_view text) {
  const auto maps = read_colormaps(temp(name, text));
  REQUIRE(maps.size() == 1);
  return maps[0];
}
std::string refusal(const std::string& name, std::string_view text) {
  return test::error_of([&] { read_colormaps(temp(name, text)); });
}

const std::string slices =
    "# COLOR_MODEL = RGB\n# HARD_HINGE\n# RANGE = -8000/4000\n-1\t0/0/128\t0\t128/128/255\n0 0/128/0 1 white ; land\nB black\nF 255/0/0\nN "
    "128\n";
const std::string paraview =
    R"([{"Name":"A B","ColorSpace":"Diverging","NanColor":[1,1,0],"RGBPoints":[0,0.23137,0.29804,0.75294,0.5,0.865,0.865,0.865,1,0.70588,0.015686,0.14902]},
        {"Name":"hues","ColorSpace":"HSV","RGBPoints":[-1,0,0,1,1,1,0,0]},
        {"Name":"names","IndexedColors":[1,0,0,0,1,0,0,0,1],"Annotations":["3","three",5,"five",8,"eight"]}])";
const std::string niivue =
    R"({"min":180,"max":600,"R":[0,0,113,255],"G":[0,0,109,250],"B":[0,0,101,245],"A":[0,0,100,160],"I":[0,1,128,255]})";
const std::string css =
    ".Set1 .q0-2{fill:rgb(1,2,3)}\n.Set1 .q1-2{fill:rgb(4,5,6)}\n/* x */\n.YlGn .q0-2{fill:rgb(0,0,0)}\n.YlGn "
    ".q1-2{fill:rgb(255,255,255)}\n"
    ".YlGn .q0-3{fill:rgb(0,0,0)}\n.YlGn .q1-3{fill:rgb(100,100,100)}\n.YlGn .q2-3{fill:rgb(255,255,255)}\n";

}  // namespace

TEST_CASE("colour map files: a .cpt has slices, a hinge, a range and colours beyond its ends") {
  const FileColormap f = one("a.cpt", slices);
  CHECK(f.entries == 2);
  CHECK(f.lo == -1);
  CHECK(f.hi == 1);
  CHECK(f.range_lo == -8000);
  CHECK(f.range_hi == 4000);
  CHECK(f.hinge == 0);
  CHECK(f.hard_hinge);
  CHECK(f.map.kind == MapKind::diverging);
  CHECK(color_text(f.map.at(0)) == "#000080");
  CHECK(color_text(f.map.at(1)) == "#ffffff");
  CHECK(color_text(*f.below) == "#000000");
  CHECK(color_text(*f.above) == "#ff0000");
  CHECK(color_text(*f.nan) == "#808080");
  CHECK(length(f.map.at(0.25) - Vec3f(64, 64, 191.5) / 255.f) < 0.01f);
  // A step at the hinge: blue before it, green behind it.
  CHECK(f.map.at(0.498).z > 0.9f);
  CHECK(f.map.at(0.502).z < 0.1f);
}

TEST_CASE("colour map files: a hard hinge lies at 0, whatever the range") {
  const FileColormap f = one("h.cpt", slices);
  for (const auto& [lo, hi] : {std::pair{-9000.0, 1000.0}, {-10.0, 300.0}, {5.0, 10.0}, {-10.0, -5.0}}) {
    CAPTURE(lo);
    const Colormap m = hinged(f, lo, hi);
    if (lo < 0) CHECK(color_text(m.at(0)) == "#000080");
    if (hi > 0) CHECK(color_text(m.at(1)) == "#ffffff");
    const double zero = -lo / (hi - lo);
    if (lo < 0 && hi > 0) {
      CHECK(m.at(zero - 0.005).z > 0.85f);
      CHECK(m.at(zero + 0.005).x < 0.5f);
    }
  }
}

TEST_CASE("colour map files: colours as HSV, CMYK, greys, names with shades, and in old columns") {
  CHECK(color_text(one("hsv.cpt", "# COLOR_MODEL = +HSV\n0 0-1-1 1 120-1-1\n").map.at(1)) == "#00ff00");
  CHECK(color_text(one("hsv2.cpt", "# COLOR_MODEL = hsv\n0 240/1/0.5 1 60/0/1\n").map.at(0)) == "#000080");
  const FileColormap hsv = one("hsv3.cpt", "# COLOR_MODEL = HSV\n0 0-1-1 1 240-1-1\n");
  CHECK(length(hsv.map.at(0.5) - Vec3f(0, 1, 0)) < 0.01f);  // over green, not through purple
  // A whole turn is one, and greys have the hue that the table gives them.
  const FileColormap turn = one("turn.cpt", "# COLOR_MODEL = +HSV\n# CYCLIC\n0 0-1-1 1 360-1-1\n");
  CHECK(length(turn.map.at(1 / 3.0) - Vec3f(0, 1, 0)) < 0.01f);
  CHECK(turn.map.kind == MapKind::unsafe);  // closed, but its lightness rises and falls three times
  const FileColormap dark = one("dark.cpt", "# COLOR_MODEL = +HSV\n0 240-1-0 1 240-1-1\n");
  CHECK(length(dark.map.at(0.5) - Vec3f(0, 0, 0.5f)) < 0.01f);
  CHECK(color_text(one("columns.cpt", "# COLOR_MODEL = +HSV\n0 240 1 1 1 240 0 1\n").map.at(0)) == "#0000ff");
  CHECK(color_text(one("word.cpt", "# COLOR_MODEL = +HSV\n0 red 1 blue\n").map.at(0)) == "#ff0000");
  CHECK(color_text(one("cmyk.cpt", "# COLOR_MODEL = CMYK\n0 100/0/0/0 1 0/0/100/50\n").map.at(0)) == "#00ffff");
  CHECK(color_text(one("cmyk2.cpt", "# COLOR_MODEL = CMYK\n0 100/0/0/0 1 0/0/100/50\n").map.at(1)) == "#808000");
  CHECK(color_text(one("old.cpt", "0 10 20 30 1 40 50 60 B\n").map.at(1)) == "#28323c");
  CHECK(color_text(one("grey.cpt", "0 10 1 gray100\n").map.at(0)) == "#0a0a0a");
  CHECK(color_text(one("hex.cpt", "0 #102030 1 red@50\n").map.at(0)) == "#102030");
  CHECK(color_text(one("names.cpt", "0 green 1 darkorange1\n").map.at(0)) == "#00ff00");
  CHECK(color_text(one("names2.cpt", "0 green 1 darkorange1\n").map.at(1)) == "#ff7f00");
  CHECK(color_text(one("names3.cpt", "0 red4 1 blue2\n").map.at(0)) == "#8b0000");
}

TEST_CASE("colour map files: categories keep their keys and labels") {
  const FileColormap f = one("c.cpt", "3 red ;sand\n7 0/0/255\nN 128\n");
  CHECK(f.map.categorical());
  CHECK(f.labels == std::vector<double>{3, 7});
  CHECK(f.label_names[0] == "sand");
  CHECK(color_text(f.map.colors[1]) == "#0000ff");
  const FileColormap words = one("w.cpt", "clay red\nsilt blue\n");
  CHECK(words.labels == std::vector<double>{0, 1});
  CHECK(words.label_names[1] == "silt");
}

TEST_CASE("colour map files: errors of a .cpt name the line") {
  CHECK(contains(refusal("e1.cpt", "# x\n0 1/2/3 0 4/5/6\n"), "line 2"));
  CHECK(contains(refusal("e2.cpt", "0 1/2/300 1 4/5/6\n"), "'1/2/300' is not a colour"));
  CHECK(contains(refusal("e3.cpt", "0 red 1 blue\n2 red 3 blue\n"), "line 2: a slice begins at 2"));
  CHECK(contains(refusal("e4.cpt", "0 red 1 blue\n4 blue\n"), "slices and categories"));
  CHECK(contains(refusal("e5.cpt", "0 notacolour 1 blue\n"), "'notacolour'"));
  CHECK(contains(refusal("e6.cpt", "zero red 1 blue\n"), "'zero' is not a number"));
  CHECK(contains(refusal("e7.cpt", "# only words\n"), "neither slices"));
  CHECK(contains(refusal("e8.cpt", "# COLOR_MODEL = LAB\n0 1 1 2\n"), "colour model"));
  CHECK(contains(refusal("e9.cpt", "0 red 1\n"), "3 words"));
}

TEST_CASE("colour map files: ParaView's spaces and indexed colours") {
  const auto maps = read_colormaps(temp("p.json", paraview));
  REQUIRE(maps.size() == 3);
  CHECK(maps[0].map.name == "A B");
  CHECK(maps[0].map.kind == MapKind::diverging);
  CHECK(*maps[0].nan == Vec3f(1, 1, 0));
  // Moreland's map: between two of its control points as the built-in one, which is made from its ends alone.
  const Colormap ours = find_colormap("coolwarm");
  for (double t : {0.0, 0.1, 0.25, 0.4, 0.5, 0.7, 0.9, 1.0})
    CHECK(ciede2000(srgb_to_lab(Vec3(maps[0].map.at(t))), srgb_to_lab(Vec3(ours.at(t)))) < 2);
  CHECK(length(maps[1].map.at(0.5) - Vec3f(0, 1, 0)) < 0.01f);
  CHECK(maps[1].lo == -1);
  CHECK(maps[2].map.categorical());
  CHECK(maps[2].labels == std::vector<double>{3, 5, 8});
  CHECK(maps[2].label_names[2] == "eight");
  CHECK(contains(refusal("p1.json", R"([{"Name":"q","RGBPoints":[0,0,0]}])"), "map 'q'"));
  CHECK(contains(refusal("p2.json", R"([{"Name":"q","RGBPoints":[0,0,0,2]}])"), "is not a colour"));
  CHECK(contains(refusal("p3.json", R"([{"Name":"q","RGBPoints":[1,0,0,0,0,1,1,1]}])"), "do not increase"));
  CHECK(contains(refusal("p4.json", R"({"a":1})"), "not a colour map"));
  CHECK(contains(refusal("p5.json", std::string(100, '[') + std::string(100, ']')), "nested"));
}

TEST_CASE("colour map files: niivue's lists") {
  const FileColormap f = one("n.json", niivue);
  CHECK(f.entries == 4);
  CHECK(f.range_lo == 180);
  CHECK(f.range_hi == 600);
  CHECK(f.hi == 255);
  CHECK(color_text(f.map.at(1)) == "#fffaf5");
  CHECK(length(f.map.at(128.0 / 255) - Vec3f(113, 109, 101) / 255.f) < 0.005f);
  CHECK(contains(refusal("n1.json", R"({"R":[0,1],"G":[0],"B":[0,1]})"), "differ in length"));
}

TEST_CASE("colour map files: ColorBrewer's rules, and names of maps") {
  const std::string path = temp("b.css", css);
  const auto maps = read_colormaps(path);
  REQUIRE(maps.size() == 5);
  CHECK(maps[1].map.name == "Set1");
  CHECK(maps[1].map.categorical());
  CHECK(maps[4].map.name == "YlGn");
  CHECK(maps[4].entries == 3);
  CHECK(maps[4].map.kind == MapKind::sequential);
  CHECK(find_colormap(path + ":YlGn").at(1) == Vec3f(1, 1, 1));
  CHECK(find_colormap(path + ":ylgn-2_r").at(1) == Vec3f(0, 0, 0));
  CHECK(find_colormap(path + ":YlGn_r").name == path + ":YlGn_r");
  CHECK(contains(test::error_of([&] { find_colormap(path); }), "contains 5 maps"));
  CHECK(contains(test::error_of([&] { find_colormap(path + ":YlGm"); }), "did you mean 'YlGn'"));
  CHECK(find_colormap(temp("s.cpt", slices) + "_r").at(0) == Vec3f(1, 1, 1));
  CHECK(contains(test::error_of([] { find_colormap("nowhere.cpt"); }), "nowhere.cpt"));
  CHECK_FALSE(names_colormap_file("coolwarm"));
  CHECK_FALSE(names_colormap_file(".cpt"));
}

TEST_CASE("colour map files: cut and damaged files are read or refused") {
  const std::pair<const char*, const std::string*> files[] = {
      {"r.cpt", &slices}, {"r.json", &paraview}, {"r2.json", &niivue}, {"r.css", &css}};
  for (const auto& [name, bytes] : files) {
    CAPTURE(name);
    int refused = 0;
    auto attempt = [&](const std::string& damaged) {
      try {
        for (const FileColormap& f : read_colormaps(temp(name, damaged))) CHECK(f.map.colors.size() >= 1);
      } catch (const Error& e) {
        CHECK(e.kind() == ErrorKind::data);
        ++refused;
      }
    };
    for (size_t k = 0; k < 64; ++k) attempt(bytes->substr(0, bytes->size() * k / 64));
    for (size_t i = 0; i < std::min<size_t>(bytes->size(), 200); ++i)
      for (const unsigned char flip : {0x01, 0x80, 0xff}) {
        std::string damaged = *bytes;
        damaged[i] = char(static_cast<unsigned char>(damaged[i]) ^ flip);
        attempt(damaged);
      }
    CHECK(refused > 10);
  }
}

TEST_CASE("colour map files: every file of the data folder agrees with the manifest" * doctest::skip(test::no_data())) {
  const MappedFile manifest(test::data_file("manifest.json"));
  size_t files = 0;
  const Json all = Json::parse(manifest.text());
  for (const Json& d : all["datasets"]) {
    const std::string path = d["path"];
    if (!path.starts_with("colormaps/")) continue;
    CAPTURE(path);
    ++files;
    const auto maps = read_colormaps(test::data_file(path));
    if (!d.contains("truth")) {
      CHECK(maps.size() > 35);
      continue;
    }
    const Json& t = d["truth"];
    if (t.contains("colour_maps")) {
      REQUIRE(maps.size() == t["rows"].get<size_t>());
      for (size_t i = 0; i < maps.size(); ++i) {
        const Json& m = t["colour_maps"][i];
        CHECK(maps[i].map.name.starts_with(m["name"].get<std::string>()));
        if (m["indexed"].is_null()) {
          CHECK(maps[i].entries == m["points"].get<size_t>());
          CHECK(maps[i].space == m["space"].get<std::string>());
          CHECK(maps[i].lo == m["x_range"][0].get<double>());
          CHECK(maps[i].hi == m["x_range"][1].get<double>());
        } else {
          CHECK(maps[i].entries == m["indexed"].get<size_t>());
          CHECK(maps[i].map.categorical());
        }
        CHECK(maps[i].nan.has_value() == !m["nan_colour"].is_null());
        if (maps[i].nan) CHECK(maps[i].nan->x == doctest::Approx(m["nan_colour"][0].get<double>()));
      }
      continue;
    }
    REQUIRE(maps.size() == 1);
    const FileColormap& f = maps[0];
    if (t.contains("nodes")) {
      CHECK(f.entries == t["nodes"].get<size_t>());
      continue;
    }
    CHECK(f.entries == t["entries"].get<size_t>());
    CHECK(f.space == t["colour_model"].get<std::string>());
    CHECK(f.hinge.has_value() == t.contains("hinge"));
    if (f.hinge) CHECK(f.hard_hinge == (t["hinge"] == "HARD_HINGE"));
    CHECK(f.below.has_value() == t.contains("B"));
    CHECK(f.above.has_value() == t.contains("F"));
    CHECK(f.nan.has_value() == t.contains("N"));
    CHECK(f.range_lo.has_value() == !t["range_comment"].is_null());
    // "z colour z colour" or "key colour": the colours are r/g/b but for the first category.
    const std::string first_line = t["first"], last_line = t["last"];
    const auto first = words(first_line), last = words(last_line);
    CHECK(f.lo == *parse_double(first[0]));
    CHECK(f.hi == *parse_double(last[last.size() - 2]));
    auto same = [](Vec3f c, std::string_view rgb) {
      const auto parts = split(rgb, '/');
      if (parts.size() != 3) return rgb == "green" && color_text(c) == "#00ff00";
      return color_text(c) == fmt::format("#{:02x}{:02x}{:02x}", *parse_int(parts[0]), *parse_int(parts[1]), *parse_int(parts[2]));
    };
    CHECK(same(f.map.colors.front(), first[1]));
    CHECK(same(f.map.colors.back(), last.back()));
  }
  CHECK(files == 18);
}
