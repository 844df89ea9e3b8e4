// SPDX-License-Identifier: Apache-2.0
// Glyphs and trails from the command line.
#include "base/file/file.h"
#include "cli/program.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using test::sightglass;

TEST_CASE("render: glyphs say what was chosen, and a mesh of them is written; a shape may come from a file") {
  const std::string folder = test::temp_folder();
  auto r = sightglass({"render", "-s", "abc size=12", "--show", "glyphs count=60", "--size", "160x120", "-o", folder + "arrows.png"});
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(contains(r.err, "64 glyphs (arrow) of 'velocity' placed evenly"));
  r = sightglass({"convert", "-s", "abc size=4", "-f", "glyphs shape=cube size=0.1 size_by=constant", "-o", folder + "cubes.stl"});
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(contains(sightglass({"info", folder + "cubes.stl"}).out, "768 cells"));
  r = sightglass(
      {"render", "-s", "abc size=4", "--show", "glyphs shape=" + folder + "cubes.stl", "--size", "160x120", "-o", folder + "own.png"});
  CHECK(r.status == 0);
  r = sightglass({"render", "-s", "tangle size=8", "--show", "glyphs", "-o", folder + "x.png"});
  CHECK(r.status == 2);
  CHECK(contains(r.err, "no vector field"));
  CHECK(contains(sightglass({"render", "-s", "abc size=4", "--show", "glyphs shape=arow", "-o", folder + "x.png"}).err,
                 "did you mean 'arrow'"));
}

TEST_CASE("render: the times of a series are those of its trails") {
  const std::string out = test::temp_folder() + "trails_{n}.png";
  const auto r = sightglass({"render", "-s", "double_gyre size=21", "-f", "streamlines count=30 max_time=4", "-f", "trails length=0.5",
                             "--show", "lines field=trail", "--times", "1,2", "--size", "120x80", "-o", out});
  INFO(r.err);
  REQUIRE(r.status == 0);
  const std::string first(MappedFile(test::temp_folder() + "trails_000.png").text()),
      second(MappedFile(test::temp_folder() + "trails_001.png").text());
  CHECK(first != second);
}
