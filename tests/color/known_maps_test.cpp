// SPDX-License-Identifier: Apache-2.0
// Colour maps that people know from other programs.
#include <algorithm>
#include <set>

#include "base/text/text.h"
#include "color/cie.h"
#include "color/map_files/colormap_file.h"
#include "color/map_files/colormap_nodes.h"
#include "color/maps/brewer_maps.h"
#include "color/maps/maps_elsewhere.h"
#include "color/maps/segment_maps.h"
#include "support/test.h"

using namespace sg;

namespace {

// Lightness rises to a middle and falls behind it.
bool has_two_sides(const Colormap& map) {
  const std::vector<double> l = lightness_report(map, 257).lightness;
  const auto top = std::max_element(l.begin(), l.end());
  return std::abs(top - l.begin() - 128) < 32 && std::is_sorted(l.begin(), top) && std::is_sorted(top, l.end(), std::greater<>());
}

double off(Vec3f c, Vec3 wanted) { return length(Vec3(c) * 255 - wanted); }

}  // namespace

TEST_CASE("known maps: ColorBrewer's fall evenly from light to dark, or from both sides of a middle") {
  for (const PublishedMap& m : brewer_maps()) {
    CAPTURE(m.name);
    const Colormap map = find_colormap(m.name);
    CHECK(map.kind == m.kind);
    CHECK(map.colors.size() * 6 == m.colors.size());
    const LightnessReport r = lightness_report(map);
    if (m.kind == MapKind::sequential) {
      CHECK(map.colors.size() == 9);
      CHECK(r.falls_float == 255);
      CHECK(r.highest - r.lowest > 67);
      CHECK(lightness_report(find_colormap(std::string(m.name) + "_r")).falls_float == 0);
    } else if (m.kind == MapKind::diverging) {
      CHECK(map.colors.size() == 11);
      CHECK(has_two_sides(map));
      CHECK(std::abs(r.falls_float - 127) <= 1);
    } else {
      // No two labels of one map have the same colour.
      for (size_t i = 0; i < map.colors.size(); ++i)
        for (size_t j = 0; j < i; ++j) CHECK(length(Vec3(map.colors[i]) - Vec3(map.colors[j])) > 0.04);
    }
  }
}

TEST_CASE("known maps: ends and middles are those of ColorBrewer, Tableau and Matplotlib") {
  const struct {
    const char* name;
    Vec3 first, middle, last;
  } known[] = {{"Blues", {247, 251, 255}, {107, 174, 214}, {8, 48, 107}},
               {"Greens", {247, 252, 245}, {116, 196, 118}, {0, 68, 27}},
               {"Reds", {255, 245, 240}, {251, 106, 74}, {103, 0, 13}},
               {"YlOrRd", {255, 255, 204}, {253, 141, 60}, {128, 0, 38}},
               {"PuOr", {127, 59, 8}, {247, 247, 247}, {45, 0, 75}},
               {"hot", {10.6, 0, 0}, {255, 90.3, 0}, {255, 255, 255}},
               {"bwr", {0, 0, 255}, {255, 255, 255}, {255, 0, 0}},
               {"seismic", {0, 0, 76.5}, {255, 255, 255}, {127.5, 0, 0}},
               {"copper", {0, 0, 0}, {157.5, 99.6, 63.4}, {255, 199.2, 126.9}},
               {"hsv", {255, 0, 0}, {0, 255, 255}, {255, 0, 0}},
               {"terrain", {51, 51, 153}, {255, 255, 153}, {255, 255, 255}},
               {"gnuplot2", {0, 0, 0}, {199.2, 40.8, 214.2}, {255, 255, 255}}};
  for (const auto& k : known) {
    CAPTURE(k.name);
    const Colormap map = find_colormap(k.name);
    CHECK(off(map.at(0), k.first) < 0.2);
    CHECK(off(map.at(0.5), k.middle) < 0.2);
    CHECK(off(map.at(1), k.last) < 0.2);
  }
  const Colormap ten = find_colormap("tab10");
  REQUIRE(ten.categorical());
  CHECK(ten.colors.size() == 10);
  CHECK(off(ten.at(0), {31, 119, 180}) < 0.2);
  CHECK(off(ten.at(0.99), {23, 190, 207}) < 0.2);
  CHECK(find_colormap("tab20").colors.size() == 20);
}

TEST_CASE("known maps: those between a few places have the lightness that their kind claims") {
  for (const SegmentMap& m : segment_maps()) {
    CAPTURE(m.name);
    const Colormap map = find_colormap(m.name);
    if (m.kind == MapKind::sequential) CHECK(lightness_report(map).falls_float == 0);
    if (m.kind == MapKind::diverging) CHECK(has_two_sides(map));
    if (m.kind == MapKind::unsafe) CHECK(kind_of_colors(map) == MapKind::unsafe);
    for (const ColorStop& s : m.stops) CHECK(length(Vec3(map.at(double(s.position))) - Vec3(s.color)) < 1e-5);
  }
}

TEST_CASE("known maps: ColorBrewer's are those of its own file" * doctest::skip(test::no_data())) {
  const std::string path = test::data_file("colormaps/colorbrewer.css");
  for (const PublishedMap& m : brewer_maps()) {
    if (m.name.starts_with("tab")) continue;
    CAPTURE(m.name);
    const Colormap file = find_file_colormap(path + ":" + std::string(m.name)).map, map = find_colormap(m.name);
    REQUIRE(file.colors.size() == map.colors.size());
    for (size_t i = 0; i < map.colors.size(); ++i) CHECK(off(map.colors[i], Vec3(file.colors[i]) * 255) < 0.1);
  }
}

TEST_CASE("known maps: those that are not built in lead to one that is, by any of their names") {
  std::set<std::string> seen;
  for (const MapElsewhere& m : maps_elsewhere()) {
    CHECK_NOTHROW(find_colormap(m.here));
    for (const std::string_view word : words(m.words)) {
      CAPTURE(word);
      CHECK(seen.insert(std::string(word)).second);
      CHECK(word == to_lower(word));
      CHECK(test::error_of([&] { find_colormap(word); }).find("nearest built-in one is '" + std::string(m.here) + "'") !=
            std::string::npos);
    }
  }
  for (const char* name :
       {"berlin", "roma", "thermal", "cmo.balance", "Cool to Warm", "twilight_shifted", "gist_earth_r", "pink", "winter"}) {
    CAPTURE(name);
    CHECK(test::error_of([&] { find_colormap(name); }).find("nearest built-in one") != std::string::npos);
  }
}
