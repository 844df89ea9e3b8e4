// SPDX-License-Identifier: Apache-2.0
// Names of inputs: in those of outputs, and of steps that are taken for several things.
#include <fmt/core.h>

#include "base/file/file.h"
#include "cli/program.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using test::fresh_folder;
using test::sightglass;

TEST_CASE("convert: {name} is the name of the input") {
  const std::string f = fresh_folder("named");
  write_file(f + "s.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  CHECK(sightglass({"convert", "s.off", "-o", "{name}.ply", "-q"}, f).status == 0);
  CHECK(contains(sightglass({"info", "s.ply"}, f).out, "3 points"));
}

TEST_CASE("render: three files whose names differ by a number are drawn together, with a word of series") {
  const std::string f = fresh_folder("steps");
  for (int k = 0; k < 3; ++k) write_file(f + fmt::format("s{}.off", k), "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  write_file(f + "t.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const auto together = sightglass({"render", "s0.off", "s1.off", "s2.off", "-o", "a.png", "--size", "80x60"}, f);
  CHECK(together.status == 0);
  CHECK(contains(together.err, "--series"));
  CHECK_FALSE(contains(sightglass({"render", "s0.off", "s1.off", "t.off", "-o", "b.png", "--size", "80x60"}, f).err, "--series"));
}

TEST_CASE("--input-format: names the format of a file whose name and content do not tell it") {
  const std::string f = fresh_folder("stated");
  write_file(f + "t.dat", "# by hand\nname level\nlow 1\nhigh 2\n");
  CHECK(sightglass({"info", "t.dat"}, f).status == 3);
  const auto told = sightglass({"info", "t.dat", "--input-format", "csv", "--csv-header", "yes"}, f);
  INFO(told.err);
  CHECK(told.status == 0);
  const auto wrong = sightglass({"info", "t.dat", "--input-format", "cvs"}, f);
  CHECK(wrong.status == 2);
  CHECK(contains(wrong.err, "did you mean 'csv'"));
  // A picture remembers it.
  write_file(f + "s.bin", "# a triangle\nhello\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  CHECK(sightglass({"render", "s.bin", "-o", "s.png", "--size", "80x60"}, f).status != 0);
  CHECK(sightglass({"render", "s.bin", "--input-format", "obj", "-o", "s.png", "--size", "80x60"}, f).status == 0);
  CHECK(contains(sightglass({"open", "s.png", "--recipe"}, f).out, "format: obj"));
}
