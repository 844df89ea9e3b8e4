// SPDX-License-Identifier: Apache-2.0
// Pictures of several parts: what is said of them is said once.
#include <fmt/core.h>

#include "base/file/file.h"
#include "cli/program.h"
#include "support/test.h"

using namespace sg;
using test::must;

namespace {

size_t times_said(const std::string& text, const std::string& what) {
  size_t n = 0;
  for (size_t at = text.find(what); at != text.npos; at = text.find(what, at + 1)) ++n;
  return n;
}

// A box cut into four pieces, as a collection of parts.
void write_parts() { must({"convert", "--source", "sphere size=12", "-f", "unstructured", "--pieces", "4", "-o", "pieces.vtm"}); }

}  // namespace

TEST_CASE("parts: the share of values beyond a range is that of all of them, told once") {
  write_parts();
  const auto said_of = [](const std::string& file) {
    const std::string err =
        must({"render", file, "--show", "surface field=distance range=0,0.5 below=blue above=red", "--size", "80x60", "-o", "n.png"}).err;
    INFO(err);
    CHECK(times_said(err, "lie below the range") == 1);
    return err;
  };
  said_of("pieces.vtm");
  must({"convert", "--source", "sphere size=12", "-f", "unstructured", "-o", "whole.vtu"});
  said_of("whole.vtu");
}

TEST_CASE("parts: notes that differ in numbers alone are one, and -v has them all") {
  must({"convert", "--source", "abc size=7", "-f", "unstructured", "--pieces", "5", "-o", "pieces.vtm"});
  const std::vector<std::string> glyphs = {"render", "pieces.vtm", "--show", "glyphs place=all", "--size", "80x60", "-o", "n.png"};
  const std::string err = must(glyphs).err;
  INFO(err);
  CHECK(times_said(err, " glyphs (") == 1);
  std::vector<std::string> verbose = glyphs;
  verbose.push_back("-v");
  CHECK(times_said(must(verbose).err, " glyphs (") > 1);
}

TEST_CASE("render: of several inputs what is alike is said once") {
  const std::string f = test::fresh_folder("alike");
  std::vector<std::string> args = {"render"};
  for (int k = 0; k < 5; ++k) {
    write_file(f + fmt::format("s{}.off", k), "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    args.push_back(fmt::format("s{}.off", k));
  }
  args.insert(args.end(), {"-o", "a.png", "--size", "80x60"});
  const auto r = test::sightglass(args, f);
  INFO(r.out);
  CHECK(test::contains(r.out, "s0.off, s1.off and 3 others: surface mesh"));
  CHECK(test::contains(r.out, "s1.off, s2.off and 2 others surround s0.off: drawn with opacity=0.35, so that all are seen"));
}
