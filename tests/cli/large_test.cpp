// SPDX-License-Identifier: Apache-2.0
// Volumes that are written slab by slab, and pictures of a series.
#include <unistd.h>

#include "base/file/file.h"
#include "cli/program.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using test::sightglass;

TEST_CASE("convert: a source goes to Zarr slab by slab, in less memory than it has") {
  const std::string out = test::temp_folder() + "tangle.ome.zarr";
  const auto r = sightglass({"convert", "-s", "tangle size=260", "-o", out, "--memory", "40M"});  // 70 MB of numbers
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(contains(r.out, "260x260x260"));
  const auto whole = sightglass({"info", out}), source = sightglass({"info", "-s", "tangle size=260"});
  const auto range = [](const std::string& text) { return text.substr(text.find("field ")); };
  CHECK(range(whole.out).substr(0, 200).find(range(source.out).substr(60, 20)) != std::string::npos);
  // Within a limit it is a coarse level, and says so.
  const auto coarse = sightglass({"info", out, "--memory", "64M"});
  CHECK(coarse.status == 0);
  CHECK(contains(coarse.err, "level 2"));
  CHECK(contains(coarse.out, "65 x 65 x 65"));
}

TEST_CASE("convert: what is in the way of a Zarr folder is told") {
  const std::string out = test::temp_folder() + "file.zarr";
  write_file(out, "a file");
  CHECK(contains(sightglass({"convert", "-s", "tangle size=20", "-o", out}).err, "not a Zarr folder"));
  const auto filtered = sightglass({"convert", "-s", "tangle size=20", "-f", "contour", "-o", test::temp_folder() + "x.zarr"});
  CHECK(filtered.status == 2);
  CHECK(contains(filtered.err, "uniform grid"));
  CHECK(contains(sightglass({"convert", "-s", "tangle size=20", "-o", test::temp_folder() + "x.zarr", "--chunk", "9"}).err, "even number"));
}

TEST_CASE("render: {n} in the output numbers the pictures of a series, all in one range") {
  const std::string out = test::temp_folder() + "series_{n}.png";
  const auto r = sightglass({"render", "-s", "drift size=37", "--times", "0:4:3", "--size", "160x120", "-o", out});
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(contains(r.out, "3 pictures"));
  CHECK(contains(r.err, "one range for all pictures"));
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
  CHECK(contains(recipe.out, "time: 2"));
  CHECK(contains(recipe.out, "range"));
}

TEST_CASE("render: a series that cannot be is told") {
  const std::string out = test::temp_folder() + "bad_{n}.png";
  CHECK(contains(sightglass({"render", "-s", "drift size=9", "-o", out}).err, "--times"));
  CHECK(contains(sightglass({"render", "-s", "drift size=9", "--times", "0:1:2:3", "-o", out}).err, "not a list of times"));
  CHECK(contains(sightglass({"render", "-s", "tangle size=9", "--times", "0,1", "-o", out}).err, "has no parameter 'time'"));
  CHECK(contains(sightglass({"render", "-s", "drift size=9", "--times", "0,1", "-o", test::temp_folder() + "x.png"}).err, "{n}"));
  CHECK(contains(sightglass({"render", "-s", "drift size=9", "--times", "1:0", "-o", out}).err, "not a range of times"));
}

namespace {

// A volume that does not fit into 64 MB, made once.
const std::string& large_volume() {
  static const std::string path = [] {
    const std::string out = test::temp_folder() + "large.ome.zarr";
    const auto r = sightglass({"convert", "-s", "tangle size=220", "-o", out, "--memory", "60M"});  // 43 MB of numbers
    REQUIRE(r.status == 0);
    return out;
  }();
  return path;
}

std::vector<std::string> picture_of(const std::string& input, const std::string& output, std::vector<std::string> more = {}) {
  std::vector<std::string> args = {"render", input, "--memory", "64M", "--show", "volume", "--size", "300x200", "-o", output};
  args.insert(args.end(), more.begin(), more.end());
  return args;
}

}  // namespace

TEST_CASE("render --progressive: a picture of the level in memory first, in the end the very picture") {
  const std::string plain = test::temp_folder() + "plain.png", out = test::temp_folder() + "progressive.png";
  REQUIRE(sightglass(picture_of(large_volume(), plain)).status == 0);
  const auto r = sightglass(picture_of(large_volume(), out, {"--progressive"}));
  INFO(r.err);
  INFO(r.out);
  REQUIRE(r.status == 0);
  CHECK(contains(r.out, "level 2 of 3 (55x55x55)"));
  CHECK(contains(r.out, "bricks, a voxel covers at most 1 pixel; half as many voxels"));
  CHECK(MappedFile(out).text() == MappedFile(plain).text());
  // What fits into memory is drawn at once.
  const auto small = sightglass({"render", "-s", "tangle size=20", "--progressive", "--size", "160x120", "-o", out});
  CHECK(small.status == 0);
  CHECK(!contains(small.out, "level"));
}

TEST_CASE("render --within: a picture after that time, which says what it is made of") {
  const std::string out = test::temp_folder() + "within.png";
  const auto r = sightglass(picture_of(large_volume(), out, {"--within", "1ms"}));
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(contains(r.out, "level 2 of 3"));
  CHECK(!contains(r.out, "bricks, "));
  CHECK(file_exists(out));
  const auto long_enough = sightglass(picture_of(large_volume(), out, {"--within", "500s"}));
  CHECK(contains(long_enough.out, "at most 1 pixel"));
  CHECK(contains(sightglass(picture_of(large_volume(), out, {"--within", "soon"})).err, "e.g. 2s"));
  CHECK(contains(sightglass(picture_of(large_volume(), out, {"--within", "-1s"})).err, "is not a valid time"));
  const std::string series = test::temp_folder() + "series_within_{n}.png";
  CHECK(contains(sightglass({"render", "-s", "drift size=9", "--times", "0,1", "-o", series, "--within", "2s"}).err, "--within"));
}

TEST_CASE("render: damaged chunks of a large volume are told with their file, missing ones are the fill value") {
  const std::string bad = test::temp_folder() + "bad.ome.zarr", out = test::temp_folder() + "bad.png";
  REQUIRE(sightglass({"convert", "-s", "tangle size=220", "-o", bad, "--memory", "60M"}).status == 0);
  // The picture of 300 x 200 pixels is drawn from level 1 or coarser.
  std::string chunk;
  for (const char* name : {"/1/0/0/0", "/1/0.0.0"})
    if (file_exists(bad + name)) chunk = bad + name;
  REQUIRE(!chunk.empty());
  const std::string bytes(MappedFile(chunk).text());
  for (const std::string& damaged : {bytes.substr(0, bytes.size() / 2), std::string(), std::string(bytes.size(), '\x7f')}) {
    write_file(chunk, damaged);
    for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--progressive"}}) {
      const auto r = sightglass(picture_of(bad, out, more));
      CHECK(r.status == 3);
      CHECK(contains(r.err, chunk));
    }
  }
  ::unlink(chunk.c_str());
  CHECK(sightglass(picture_of(bad, out)).status == 0);
}
