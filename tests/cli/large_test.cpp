// SPDX-License-Identifier: Apache-2.0
// Volumes that are written slab by slab, and pictures of a series.
#include "base/file.h"
#include "cli/program.h"
#include "support/test.h"

using namespace sg;
using test::sightglass;

namespace {
bool has(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }
}  // namespace

TEST_CASE("convert: a source goes to Zarr slab by slab, in less memory than it has") {
  const std::string out = test::temp_folder() + "tangle.ome.zarr";
  const auto r = sightglass({"convert", "-s", "tangle size=260", "-o", out, "--memory", "40M"});  // 70 MB of numbers
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(has(r.out, "260x260x260"));
  const auto whole = sightglass({"info", out}), source = sightglass({"info", "-s", "tangle size=260"});
  const auto range = [](const std::string& text) { return text.substr(text.find("field ")); };
  CHECK(range(whole.out).substr(0, 200).find(range(source.out).substr(60, 20)) != std::string::npos);
  // Within a limit it is a coarse level, and says so.
  const auto coarse = sightglass({"info", out, "--memory", "64M"});
  CHECK(coarse.status == 0);
  CHECK(has(coarse.err, "level 2"));
  CHECK(has(coarse.out, "65 x 65 x 65"));
}

TEST_CASE("convert: what is in the way of a Zarr folder is told") {
  const std::string out = test::temp_folder() + "file.zarr";
  write_file(out, "a file");
  CHECK(has(sightglass({"convert", "-s", "tangle size=20", "-o", out}).err, "no Zarr folder"));
  const auto filtered = sightglass({"convert", "-s", "tangle size=20", "-f", "contour", "-o", test::temp_folder() + "x.zarr"});
  CHECK(filtered.status == 2);
  CHECK(has(filtered.err, "uniform grid"));
  CHECK(has(sightglass({"convert", "-s", "tangle size=20", "-o", test::temp_folder() + "x.zarr", "--chunk", "9"}).err, "even number"));
}

TEST_CASE("render: {n} in the output numbers the pictures of a series, all in one range") {
  const std::string out = test::temp_folder() + "series_{n}.png";
  const auto r = sightglass({"render", "-s", "drift size=37", "--times", "0:4:3", "--size", "160x120", "-o", out});
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(has(r.out, "3 pictures"));
  CHECK(has(r.err, "one range for all pictures"));
  std::string first;
  for (const char* n : {"000", "001", "002"}) {
    const std::string path = test::temp_folder() + "series_" + n + ".png";
    REQUIRE(file_exists(path));
    const std::string bytes(MappedFile(path).text());
    CHECK(bytes != first);
    first = bytes;
  }
  // The same picture as alone, when it is given what the series chose.
  const auto recipe = sightglass({"open", "--recipe", test::temp_folder() + "series_001.png"});
  CHECK(has(recipe.out, "time: 2"));
  CHECK(has(recipe.out, "range"));
}

TEST_CASE("render: a series that cannot be is told") {
  const std::string out = test::temp_folder() + "bad_{n}.png";
  CHECK(has(sightglass({"render", "-s", "drift size=9", "-o", out}).err, "--times"));
  CHECK(has(sightglass({"render", "-s", "drift size=9", "--times", "0:1:2:3", "-o", out}).err, "no list of times"));
  CHECK(has(sightglass({"render", "-s", "tangle size=9", "--times", "0,1", "-o", out}).err, "has no time"));
  CHECK(has(sightglass({"render", "-s", "drift size=9", "--times", "0,1", "-o", test::temp_folder() + "x.png"}).err, "{n}"));
  CHECK(has(sightglass({"render", "-s", "drift size=9", "--times", "1:0", "-o", out}).err, "no range of times"));
}
