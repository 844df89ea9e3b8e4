// SPDX-License-Identifier: Apache-2.0
// Several inputs, or several views, in one picture.
#include "pipeline/picture/picture.h"
#include "support/test.h"

using namespace sg;
using test::error_of;

namespace {

constexpr const char* two =
    "sightglass: 1\nsteps:\n  a: {tangle: {size: 8}}\n  b: {gyroid: {size: 8}}\n"
    "show: [{outline: {}, of: a}, {outline: {}, of: b}]\npicture: {";

Image drawn(const std::string& text) {
  PipelineFile file = parse_pipeline(text + "}\n", "", picture_vocabulary());
  Context context;
  return make_picture(file, {}, context).image;
}

Image part(const Image& whole, int x0, int y0, int width, int height) {
  Image r(width, height, whole.channels);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) std::copy_n(whole.at(x0 + x, y0 + y), whole.channels, r.at(x, y));
  return r;
}

}  // namespace

TEST_CASE("layout: each input has a panel, which is the picture of it alone with its name above") {
  const std::string one = "sightglass: 1\nsteps:\n  b: {gyroid: {size: 8}}\nshow: [{outline: {}}]\npicture: {size: 120x100, title: b}\n";
  PipelineFile file = parse_pipeline(one, "", picture_vocabulary());
  Context context;
  const Image alone = make_picture(file, {}, context).image;
  CHECK(part(drawn(std::string(two) + "size: 240x100, layout: 2x1"), 120, 0, 120, 100).pixels == alone.pixels);
  CHECK(part(drawn(std::string(two) + "size: 120x200, layout: 1x2"), 0, 100, 120, 100).pixels == alone.pixels);
  CHECK(drawn(std::string(two) + "size: 240x100, layout: auto").pixels == drawn(std::string(two) + "size: 240x100, layout: 2x1").pixels);
  CHECK(drawn(std::string(two) + "size: 120x200, layout: auto").pixels == drawn(std::string(two) + "size: 120x200, layout: 1x2").pixels);
}

TEST_CASE("layout: views of the same data side by side, with one legend beside them") {
  const std::string text = "sightglass: 1\nsteps:\n  a: {tangle: {size: 8}}\nshow: [{surface: {field: tangle}}]\npicture: {size: 320x120, ";
  const Image views = drawn(text + "views: [front, top]"), top = drawn(text + "views: [top, front]");
  CHECK(views.pixels != top.pixels);
  // The legend stands right of both, the same in both pictures, and the two panels have changed places.
  int legend = 320;
  while (legend > 0 && part(views, legend - 1, 0, 1, 120).pixels == part(top, legend - 1, 0, 1, 120).pixels) --legend;
  const int panel = legend / 2;
  CHECK(legend < 310);
  CHECK(panel > 60);
  CHECK(part(views, 20, 30, 60, 60).pixels != part(views, 20 + panel, 30, 60, 60).pixels);
}

TEST_CASE("layout: the legend stands at its side of all panels, and tells of a panel without values") {
  const auto picture = [&](const std::string& formula, const std::string& legend) {
    // Two planes with the same range of values; the second one may have places without a value.
    return drawn(
        "sightglass: 1\nsteps:\n"
        "  a: {tangle: {size: 8}}\n  as: {slice: {axis: z}}\n  ac: {calc: {expr: x, name: v}}\n"
        "  b: {tangle: {size: 8}}\n  bs: {slice: {axis: z}}\n  bc: {calc: {expr: \"" +
        formula + "\", name: v}}\nshow: [{surface: {field: v" + legend + "}, of: ac}, {surface: {field: v" + legend +
        "}, of: bc}]\npicture: {size: 400x200, layout: 2x1, axes: false");
  };
  const Image right = picture("x", ""), bottom = picture("x", ", legend_place: bottom");
  // Ink in the lowest rows is that of the numbers below the bar.
  const auto ink = [](const Image& i, int x0, int y0, int x1, int y1) {
    int n = 0;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) n += i.at(x, y)[0] + i.at(x, y)[1] + i.at(x, y)[2] < 700;
    return n;
  };
  CHECK(ink(bottom, 0, 180, 400, 196) > 60);
  CHECK(ink(right, 0, 180, 340, 196) == 0);
  CHECK(ink(right, 340, 60, 400, 140) > 300);
  // NaN in the second panel alone: a swatch of its colour.
  const auto grey = [](const Image& i, int from) {
    int n = 0;
    for (int y = 0; y < i.height; ++y)
      for (int x = from; x < i.width; ++x) n += i.at(x, y)[0] == 153 && i.at(x, y)[1] == 153 && i.at(x, y)[2] == 153;
    return n;
  };
  CHECK(grey(right, 340) == 0);
  CHECK(grey(picture("abs(y) < 0.5 ? 0/0 : x", ""), 340) > 30);
}

TEST_CASE("layout: what cannot be is told") {
  const auto told = [](const std::string& words) { return error_of([&] { drawn(std::string(two) + "size: 240x100, " + words); }); };
  CHECK(told("layout: 1x1").find("1x1 has no place for 2 panels") != std::string::npos);
  CHECK(told("layout: two").find("'two' is not a layout") != std::string::npos);
  CHECK(told("layout: 0x3").find("'0x3' is not a layout") != std::string::npos);
  CHECK(told("views: [fron]").find("did you mean 'front'") != std::string::npos);
}
