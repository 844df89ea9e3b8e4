// SPDX-License-Identifier: Apache-2.0
// How planes cut through data are drawn, sizes of pictures by name, and which shapes may tell what is up.
#include <algorithm>

#include "pipeline/picture/picture.h"
#include "pipeline/picture/picture_parts.h"
#include "support/test.h"

using namespace sg;

namespace {

std::vector<std::string> words_of_show(const std::string& slice, const std::string& surface = "{}") {
  PipelineFile file = parse_pipeline("sightglass: 1\nsteps:\n  a: {sphere: {size: 8}}\n  cut: {slice: " + slice +
                                         "}\nshow:\n  - {surface: " + surface + "}\npicture: {size: 40x30}\n",
                                     "", picture_vocabulary());
  Context context;
  make_picture(file, {}, context);
  return file.show[0].words;
}

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

TEST_CASE("planes: colours of planes that cut data are those of the legend, unlit, unless it is stated") {
  CHECK(has(words_of_show("{planes: xyz}"), "lit=false"));
  CHECK(has(words_of_show("{normal: [1, 1, 0]}"), "lit=false"));
  CHECK_FALSE(has(words_of_show("{sphere: [0, 0, 0, 0.5]}"), "lit=false"));
  CHECK_FALSE(has(words_of_show("{planes: xyz}", "{lit: true}"), "lit=false"));
  CHECK_FALSE(has(words_of_show("{planes: xyz}", "{color: tomato}"), "lit=false"));
}

TEST_CASE("planes: sizes that have names") {
  int w = 0, h = 0;
  parse_size("4K", w, h);
  CHECK(w == 3840);
  CHECK(h == 2160);
  parse_size("hd", w, h);
  CHECK(w == 1920);
  CHECK(test::error_of([&] { parse_size("5K", w, h); }).find("or HD, 4K or 8K") != std::string::npos);
}

TEST_CASE("planes: what a contour makes of a volume is no shape that stands on something") {
  const PipelineFile file = parse_pipeline(
      "sightglass: 1\nsteps:\n  a: {read: cow.ply}\n  s: {smooth: {}}\n  b: {read: head.vti}\n  c: {contour: {values: [1]}}\n"
      "  d: {sphere: {}}\n",
      "", picture_vocabulary());
  CHECK(is_shape_of_file(file, "a"));
  CHECK(is_shape_of_file(file, "s"));
  CHECK_FALSE(is_shape_of_file(file, "c"));
  CHECK_FALSE(is_shape_of_file(file, "d"));
}
