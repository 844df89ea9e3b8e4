// SPDX-License-Identifier: Apache-2.0
// Pictures by paths as a user has them: on the way, within a time, with layers, denoised, as films.
#include <string>
#include <vector>

#include "cli/program.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using test::sightglass;

namespace {

test::Ran render(const std::string& output, std::vector<std::string> more) {
  std::vector<std::string> args{"render", "--source", "gyroid size=12", "-f", "contour values=0", "--size", "64x48", "--integrator", "path",
                                "-o",     output};
  args.insert(args.end(), more.begin(), more.end());
  return sightglass(args);
}
std::string recipe_of(const std::string& picture) { return sightglass({"open", picture, "--recipe"}).out; }
bool makes_itself_again(const std::string& picture) {
  return sightglass({"open", picture, "-o", "again.png"}).status == 0 && test::bytes_of("again.png") == test::bytes_of(picture);
}

}  // namespace

TEST_CASE("noise: a target that is never met ends by time or paths, says so, and its recipe makes the same bytes") {
  test::Ran ran = render("timed.png", {"--noise", "0.0001", "--picture", "seconds=0.3 paths=100000"});
  CHECK(ran.status == 0);
  CHECK(contains(ran.err + ran.out, "noise=0.0001 was not reached everywhere in 0.3 s"));
  CHECK(contains(recipe_of("timed.png"), "stop: "));
  CHECK_FALSE(contains(recipe_of("timed.png"), "seconds"));
  CHECK(makes_itself_again("timed.png"));
  ran = render("within.png", {"--noise", "0.0001", "--picture", "paths=100000", "--within", "1s"});
  CHECK(ran.status == 0);
  CHECK(contains(ran.err + ran.out, "after "));
  CHECK(contains(recipe_of("within.png"), "stop: "));
  CHECK(makes_itself_again("within.png"));
  ran = render("few.png", {"--noise", "0.0001", "--picture", "paths=4"});
  CHECK(contains(ran.err + ran.out, "noise=0.0001 was not reached everywhere with paths=4"));
}

TEST_CASE("noise: --progressive ends with the bytes of the picture without it, and tells each that it wrote") {
  REQUIRE(render("whole.png", {"--noise", "0.02"}).status == 0);
  const test::Ran ran = render("grown.png", {"--noise", "0.02", "--progressive"});
  CHECK(ran.status == 0);
  CHECK(contains(ran.out + ran.err, "2 paths a pixel on average, standard error "));
  CHECK(test::bytes_of("grown.png") == test::bytes_of("whole.png"));
}

TEST_CASE("denoise: is named in the recipe and the note") {
  const test::Ran ran = render("denoised.png", {"--noise", "0.1", "--denoise", "yes"});
  CHECK(ran.status == 0);
  CHECK(contains(ran.err + ran.out, "denoised"));
  CHECK(contains(recipe_of("denoised.png"), "denoise: yes"));
  CHECK(makes_itself_again("denoised.png"));
  REQUIRE(render("noisy.png", {"--noise", "0.1"}).status == 0);
  CHECK(test::bytes_of("noisy.png") != test::bytes_of("denoised.png"));
}

TEST_CASE("layers: what lies behind the colours is written as data") {
  CHECK(render("layered.png", {"--noise", "0.1", "--layers", "layers.vti"}).status == 0);
  const std::string info = sightglass({"info", "layers.vti"}).out;
  for (const char* part : {"uniform 64 x 48 x 1", "light", "color", "depth", "show", "error", "albedo", "normal"})
    CHECK_MESSAGE(contains(info, part), part);
  CHECK_FALSE(contains(recipe_of("layered.png"), "layers"));
  CHECK(sightglass({"render", "layers.vti", "--show", "surface field=error", "--size", "64x48", "-o", "error.png"}).status == 0);
  // Without an integrator there is no error.
  CHECK(sightglass({"render", "--source", "gyroid size=12", "--size", "64x48", "-o", "plain.png", "--layers", "plain.vti"}).status == 0);
  CHECK_FALSE(contains(sightglass({"info", "plain.vti"}).out, "error"));
  CHECK(contains(render("a.png", {"--layers", "a.xyzzy"}).err, "xyzzy"));
  CHECK(contains(render("a_{n}.png", {"--layers", "a.vti", "--times", "0:1:2"}).err, "layers_{n}.vti"));
}

TEST_CASE("noise: pictures of films have targets and are denoised, too") {
  const test::Ran ran = sightglass({"render", "--source", "gyroid size=12", "-f", "contour values={t}", "--size", "48x32", "--integrator",
                                    "path", "--noise", "0.1", "--denoise", "yes", "--times", "0:0.2:2", "-o", "film_{n}.png"});
  CAPTURE(ran.err);
  CHECK(ran.status == 0);
  CHECK(contains(recipe_of("film_000.png"), "denoise: yes"));
  CHECK(test::bytes_of("film_000.png") != test::bytes_of("film_001.png"));
}
