// SPDX-License-Identifier: Apache-2.0
// Words that stand without the quotes they need, and patterns that a shell has spread: the message shows how it is written.
#include "cli/hints/loose_words.h"

#include <fmt/core.h>

#include "base/file/file.h"
#include "cli/hints/step_files.h"
#include "cli/program.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using test::fresh_folder;
using test::sightglass;

namespace {

const char* const triangle = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

std::string refused(const std::vector<std::string>& args, const std::vector<std::string>& inputs) {
  return test::error_of([&] { refuse_loose_words(args, inputs, "render"); });
}

}  // namespace

TEST_CASE("quotes: words of -f and --show with commas are not taken for files of a series") {
  for (const auto& [text, words] : std::vector<std::pair<std::string, std::vector<std::string>>>{
           {"-f 'slice normal=0,0,1'", {"-f", "slice", "normal=0,0,1"}},
           {"-f 'clip box=0,1,0,1,0,1'", {"-f", "clip", "box=0,1,0,1,0,1"}},
           {"-f 'contour field=T values=1,2'", {"-f", "contour", "field=T", "values=1,2"}},
           {"-f 'contour values=1,2'", {"-f", "contour", "values=1,", "2"}},
           {"--show 'surface edges=true'", {"--show=surface", "edges=true"}},
           {"--camera 'azimuth=30 elevation=10'", {"--camera", "azimuth=30", "elevation=10"}},
           {"--title 'my nice title'", {"--title", "my", "nice", "title"}},
           {"--title \"it's here\"", {"--title", "it's", "here"}},
       }) {
    std::vector<std::string> args = words, inputs(words.begin() + (words[0].find('=') == std::string::npos ? 2 : 1), words.end());
    args.insert(args.begin(), "a.off"), inputs.insert(inputs.begin(), "a.off");
    args.insert(args.end(), {"-o", "q.png"});
    const std::string error = refused(args, inputs);
    INFO(error);
    CHECK(contains(error, text));
  }
}

TEST_CASE("quotes: names of files, of series, and of files that are not there pass") {
  const std::string f = fresh_folder("loose");
  write_file(f + "a=1,2.off", triangle), write_file(f + "plain", triangle);
  for (const std::string& input :
       {f + "a=1,2.off", f + "plain", f + "a=*.off", std::string("missing.vtu"), std::string("no/such"), std::string("data_{n}.vtk")}) {
    CAPTURE(input);
    CHECK_NOTHROW(refuse_loose_words({"--title", "T", input}, {input}, "render"));
    CHECK_NOTHROW(refuse_loose_words({"-f", "faces", input}, {input}, "render"));
  }
  CHECK(contains(refused({"values=3"}, {"values=3"}), "-f 'contour values=3'"));
}

TEST_CASE("quotes: the program says them for render, convert and info") {
  const std::string f = fresh_folder("loose_program");
  write_file(f + "a.off", triangle);
  for (const char* command : {"render", "convert", "info"}) {
    std::vector<std::string> args = {command, "a.off", "-f", "slice", "normal=0,0,1"};
    if (command != std::string("info")) args.insert(args.end(), {"-o", command == std::string("render") ? "a.png" : "a.vtp"});
    const auto r = sightglass(args, f);
    INFO(r.err);
    CHECK(r.status == 2);
    CHECK(contains(r.err, "-f 'slice normal=0,0,1'"));
  }
}

TEST_CASE("files of one series: the pattern that a shell has spread is named") {
  const std::string f = fresh_folder("spread");
  std::vector<std::string> paths, two;
  for (int k = 8; k < 12; ++k) {
    paths.push_back(f + fmt::format("s2_{}.off", k)), two.push_back(f + fmt::format("t{}_{:02}.off", k, k));
    write_file(paths.back(), triangle), write_file(two.back(), triangle);
  }
  CHECK(as_series(paths) == "'" + f + "s2_{n}.off' in quotes, or --series FILES...");
  CHECK(as_series(two) == "'" + f + "t*_*.off' in quotes, or --series FILES...");
  CHECK(as_series({paths[0], paths[1]}).empty());
  CHECK(as_series({paths[0], paths[1], f + "other.off"}).empty());
  CHECK(as_series({paths[0], paths[1], paths[2]}) == "--series FILES...");  // the pattern has one more

  const auto drawn = sightglass({"render", "s2_8.off", "s2_9.off", "s2_10.off", "s2_11.off", "-o", "a.png", "--size", "80x60"}, f);
  INFO(drawn.err);
  CHECK(drawn.status == 0);
  CHECK(contains(drawn.err, "'s2_{n}.off' in quotes"));
  const auto converted = sightglass({"convert", "s2_8.off", "s2_9.off", "s2_10.off", "-o", "b.vtp"}, f);
  INFO(converted.err);
  CHECK(converted.status == 2);
  CHECK(contains(converted.err, "for f in FILES"));
  CHECK(contains(converted.err, "-o '{name}.vtp'"));
  CHECK(contains(converted.err, "--series FILES..."));
  CHECK(contains(sightglass({"convert", "s2_8.off", "t8_08.off", "-o", "b.vtp"}, f).err, "append with=FILE"));
}
