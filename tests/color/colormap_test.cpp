// SPDX-License-Identifier: Apache-2.0
#include "color/colormap.h"

#include <algorithm>
#include <set>

#include "color/cie.h"
#include "color/map_files/colormap_nodes.h"
#include "color/maps/brewer_maps.h"
#include "color/published_maps.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("colour maps: names are unique, colours within [0,1], and each can be reversed") {
  std::set<std::string> names;
  for (const Colormap& map : colormaps()) {
    INFO(map.name);
    CHECK(names.insert(map.name).second);
    CHECK(map.colors.size() >= 2);
    CHECK(!map.about.empty());
    for (const Vec3f& c : map.colors)
      for (int k = 0; k < 3; ++k) CHECK((c[k] >= 0 && c[k] <= 1));
    const Colormap back = find_colormap(map.name + "_r");
    CHECK(back.name == map.name + "_r");
    CHECK(back.kind == map.kind);
    CHECK(back.at(0) == map.at(1));
    CHECK(back.at(1) == map.at(0));
  }
  CHECK(colormaps().front().name == "sight");
}

TEST_CASE("colour maps: sequential maps never fall in lightness; 8 bits add at most ten falls") {
  for (const Colormap& map : colormaps()) {
    if (map.kind != MapKind::sequential) continue;
    INFO(map.name);
    if (std::any_of(brewer_maps().begin(), brewer_maps().end(), [&](const PublishedMap& m) { return m.name == map.name; })) continue;
    const LightnessReport r = lightness_report(map);
    CHECK(r.lightness.size() == 256);
    CHECK(r.falls_float == 0);
    CHECK(r.falls_8bit <= 10);
    CHECK(r.highest - r.lowest >= 75);
    CHECK(lightness_report(find_colormap(map.name + "_r")).falls_float == 255);
  }
}

TEST_CASE("colour maps: lightness is linear and colour steps are even in our own sequential maps") {
  for (const char* name : {"sight", "ember", "ice", "bone", "gray"}) {
    INFO(name);
    const LightnessReport r = lightness_report(find_colormap(name));
    double worst = 0;
    for (int i = 0; i < 256; ++i) worst = std::max(worst, std::abs(r.lightness[size_t(i)] - (r.lowest + (r.highest - r.lowest) * i / 255)));
    CHECK(worst < 1e-3);
  }
  for (const char* name : {"sight", "ember", "ice"}) {
    INFO(name);
    const LightnessReport r = lightness_report(find_colormap(name));
    CHECK(r.steepest / r.flattest < 1.02);
  }
}

TEST_CASE("colour maps: jet's lightness falls in 114 of 255 steps, in 115 after rounding to 8 bits") {
  const Colormap jet = find_colormap("jet");
  CHECK(jet.kind == MapKind::unsafe);
  for (int i = 0; i <= 1000; ++i) {
    const double x = i / 1000.0;
    const Vec3f c = jet.at(x);
    for (int k = 0; k < 3; ++k)
      CHECK(c[k] == doctest::Approx(std::clamp(1.5 - std::abs(4 * x - (3 - k)), 0.0, 1.0)).epsilon(1e-6).scale(1));
  }
  const LightnessReport r = lightness_report(jet);
  CHECK(r.falls_float == 114);
  CHECK(r.falls_8bit == 115);
}

TEST_CASE("colour maps: cool-warm has Moreland's ends and middle") {
  const Colormap map = find_colormap("coolwarm");
  const auto is = [](Vec3f c, int r, int g, int b, double slack) {
    CHECK(std::abs(c.x * 255 - r) <= slack);
    CHECK(std::abs(c.y * 255 - g) <= slack);
    CHECK(std::abs(c.z * 255 - b) <= slack);
  };
  is(map.at(0), 59, 76, 192, 1e-4);
  is(map.at(1), 180, 4, 38, 1e-4);
  is(map.at(0.5), 221, 221, 221, 1);
}

TEST_CASE("colour maps: our diverging maps rise to the middle and fall after it, equally far") {
  for (const char* name : {"coolwarm", "purple_green"}) {
    const Colormap map = find_colormap(name);
    INFO(map.name);
    const LightnessReport r = lightness_report(map, 257);
    for (size_t i = 1; i <= 128; ++i) {
      CHECK(r.lightness[i] > r.lightness[i - 1]);
      CHECK(r.lightness[128 + i] < r.lightness[127 + i]);
    }
    CHECK(std::abs(r.lightness.front() - r.lightness.back()) < 4);
    const Vec3 middle = srgb_to_lab(Vec3(map.at(0.5)));
    CHECK(std::hypot(middle.y, middle.z) < 1);
  }
}

TEST_CASE("colour maps: the cyclic map closes, with even steps and little lightness change") {
  const Colormap map = find_colormap("phase");
  const LightnessReport r = lightness_report(map, 257);
  CHECK(map.at(0) == map.at(1));
  CHECK(r.highest - r.lowest < 12);
  CHECK(r.steepest / r.flattest < 1.02);
}

TEST_CASE("colour maps: published maps have the colours and the lightness that their authors gave them") {
  // Matplotlib's colours at 0, 128/255 and 1; Brewer's ends and middle.
  struct {
    const char* name;
    Vec3 first, middle, last;
  } known[] = {{"viridis", {68, 1, 84}, {33, 145, 140}, {253, 231, 37}},  {"magma", {0, 0, 4}, {183, 55, 121}, {252, 253, 191}},
               {"inferno", {0, 0, 4}, {188, 55, 84}, {252, 255, 164}},    {"plasma", {13, 8, 135}, {204, 71, 120}, {240, 249, 33}},
               {"cividis", {0, 34, 78}, {125, 124, 120}, {254, 232, 56}}, {"turbo", {48, 18, 59}, {164, 252, 60}, {122, 4, 3}},
               {"RdBu", {103, 0, 31}, {247, 247, 247}, {5, 48, 97}}};
  for (const auto& k : known) {
    INFO(k.name);
    const Colormap map = find_colormap(k.name);
    CHECK(length(Vec3(map.at(0)) * 255 - k.first) < 1e-3);
    CHECK(length(Vec3(map.at(1)) * 255 - k.last) < 1e-3);
    CHECK(length(Vec3(map.at(128 / 255.0)) * 255 - k.middle) < 3);
  }
  for (const PublishedMap& m : published_maps()) {
    INFO(m.name);
    const Colormap map = find_colormap(m.name);
    CHECK(map.kind == m.kind);
    // Turbo's lightness alone is that of a diverging map; its hues have no two sides.
    CHECK(kind_of_colors(map) == (m.name == "turbo" ? MapKind::diverging : m.kind));
    CHECK(map.colors.size() * 6 == m.colors.size());
  }
  CHECK(find_colormap("rdbu_R").name == "RdBu_r");
  CHECK(find_colormap("Viridis").name == "viridis");
}

TEST_CASE("colour maps: labels are far apart, the first eight most") {
  const Colormap map = find_colormap("labels");
  REQUIRE(map.categorical());
  const size_t n = map.colors.size();
  CHECK(n == 64);
  double all = HUGE_VAL, usual = HUGE_VAL, first = HUGE_VAL;
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < i; ++j) {
      const double d = ciede2000(srgb_to_lab(Vec3(map.colors[i])), srgb_to_lab(Vec3(map.colors[j])));
      all = std::min(all, d);
      if (i < 24) usual = std::min(usual, d);
      if (i < 8) first = std::min(first, d);
    }
  CHECK(all > 12);
  CHECK(usual > 17.9);
  CHECK(first > 24);
  for (size_t i = 0; i < n; ++i) CHECK(map.at((double(i) + 0.5) / double(n)) == map.colors[i]);
  CHECK(map.at(0) == map.colors.front());
  CHECK(map.at(1) == map.colors.back());
}

TEST_CASE("colour maps: cubehelix follows Green's formula") {
  const Colormap map = find_colormap("cubehelix");
  CHECK(map.at(0) == Vec3f{0, 0, 0});
  CHECK(map.at(1) == Vec3f{1, 1, 1});
  const double x = 102 / 255.0, angle = 2 * 3.14159265358979323846 * (0.5 / 3 - 1.5 * x), a = x * (1 - x) / 2;
  CHECK(map.colors[102].x == doctest::Approx(x + a * (-0.14861 * std::cos(angle) + 1.78277 * std::sin(angle))));
  CHECK(map.colors[102].z == doctest::Approx(x + a * 1.97294 * std::cos(angle)));
}

TEST_CASE("colour maps: samples are hit exactly and t is clamped") {
  const Colormap map = find_colormap("sight");
  for (size_t i = 0; i < 256; ++i) {
    const Vec3f c = map.at(double(i) / 255);
    for (int k = 0; k < 3; ++k) CHECK(c[k] == doctest::Approx(map.colors[i][k]).epsilon(1e-6));
  }
  CHECK(map.at(-1) == map.colors.front());
  CHECK(map.at(2) == map.colors.back());
  CHECK(Colormap{}.at(0.5) == Vec3f{0, 0, 0});
}

TEST_CASE("colour maps: unknown names get a suggestion") {
  CHECK(test::error_of([] { find_colormap("sihgt"); }).find("did you mean 'sight'") != std::string::npos);
  CHECK(test::error_of([] { find_colormap("cubehelx_r"); }).find("did you mean 'cubehelix'") != std::string::npos);
  CHECK(test::error_of([] { find_colormap("parula"); }).find("nearest built-in one is 'sight'") != std::string::npos);
  CHECK(test::error_of([] { find_colormap("berlin_r"); }).find("nearest built-in one is 'vik'") != std::string::npos);
  CHECK(test::error_of([] { find_colormap("virdis"); }).find("did you mean 'viridis'") != std::string::npos);
  CHECK(test::error_of([] { find_colormap("zzz"); }).find("coolwarm") != std::string::npos);
  CHECK(test::error_of([] { find_colormap("_r"); }).find("not found") != std::string::npos);
}
