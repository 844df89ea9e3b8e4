// SPDX-License-Identifier: Apache-2.0
// Lights, environments and the lens by flags: they come together, are in the recipe, and what cannot be right is refused.
#include <filesystem>
#include <string>
#include <vector>

#include "base/file/file.h"
#include "cli/program.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using test::sightglass;

namespace {

test::Ran render(std::vector<std::string> more) {
  std::vector<std::string> args{"render", "--source", "gyroid size=12", "-f", "contour values=0", "--size", "48x32", "-o", "lights.png"};
  args.insert(args.end(), more.begin(), more.end());
  return sightglass(args);
}

}  // namespace

TEST_CASE("lights: flags beside --picture and --camera all count, and the recipe has them") {
  const test::Ran ran =
      render({"--integrator", "path", "--noise", "0.2", "--picture", "paths=16 bounces=2", "--light", "sphere from=left size=0.3",
              "--light", "sun elevation=20", "--environment", "sky haze=2 background=false", "--camera", "front aperture=0.1"});
  CHECK(ran.status == 0);
  CHECK(contains(ran.err + ran.out, "light: "));
  const std::string recipe = sightglass({"open", "lights.png", "--recipe"}).out;
  for (const char* part :
       {"integrator: path", "noise: 0.2", "paths: 16", "sphere from=left size=0.3; sun elevation=20", "sky haze=2", "aperture: 0.1"})
    CHECK_MESSAGE(contains(recipe, part), part);
  CHECK(sightglass({"open", "lights.png", "-o", "again.png"}).status == 0);
  CHECK(test::bytes_of("again.png") == test::bytes_of("lights.png"));
}

TEST_CASE("layers: those that a pipeline file names lie beside it, as its picture does") {
  const std::string folder = test::temp_folder() + "beside/";
  std::filesystem::create_directories(folder);
  write_file(folder + "a.yaml",
             "sightglass: 1\nsteps:\n  a: {sphere: {size: 8}}\nshow:\n  - {surface: {}}\npicture: {size: 32x24, layers: "
             "of_a.vti}\n");
  CHECK(sightglass({"run", folder + "a.yaml"}).status == 0);
  CHECK(file_exists(folder + "of_a.vti"));
  CHECK(file_exists(folder + "a.png"));
}

TEST_CASE("lights: without an integrator a note tells what is left out") {
  const test::Ran ran = render({"--light", "sphere from=right"});
  CHECK(ran.status == 0);
  CHECK(contains(ran.err + ran.out, "--integrator path"));
}

TEST_CASE("lights: mistakes end with what would be right") {
  const auto refused = [](std::vector<std::string> more, int status, const char* text) {
    const test::Ran ran = render(std::move(more));
    CAPTURE(ran.err);
    CHECK(ran.status == status);
    CHECK(contains(ran.err, text));
  };
  refused({"--light", "spere"}, 2, "did you mean 'sphere'?");
  refused({"--light", "sphere radius=0"}, 2, "above 0");
  refused({"--light", "point color=-1,0,0"}, 2, "not a colour");
  refused({"--light", "sun elevation=95"}, 2, "90");
  refused({"--environment", "ski"}, 2, "did you mean 'sky'?");
  refused({"--environment", "none.hdr"}, 3, "none.hdr");
  refused({"--camera", "aperture=-1"}, 2, "aperture");
  refused({"--camera", "aperture=0.1 focus=0"}, 2, "focus");
  const test::Ran help = sightglass({"ops", "rectangle"});
  CHECK(contains(help.out, "width"));
  CHECK(contains(sightglass({"ops"}).out, "environments (--environment)"));
}
