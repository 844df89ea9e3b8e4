// SPDX-License-Identifier: Apache-2.0
// --verbose: what was done, in which order and how long it took.
#include "cli/program.h"
#include "support/test.h"

using namespace sg;
using test::must;

namespace {

// Each text stands behind the one before it.
void check_order(const std::string& text, const std::vector<std::string>& parts) {
  INFO(text);
  size_t at = 0;
  for (const std::string& part : parts) {
    CAPTURE(part);
    at = text.find(part, at);
    REQUIRE(at != text.npos);
    at += part.size();
  }
}

}  // namespace

TEST_CASE("--verbose: render prints each step with its time and what it made, then the drawing") {
  const std::string said =
      must({"render", "--source", "sphere size=12", "-f", "contour values=0", "--size", "80x60", "-o", "v.png", "-v"}).err;
  check_order(said, {"running 'sphere'", "s: uniform of 1728 points and 1331 cells", "running 'contour'", "surface of ", "drawing ",
                     " triangles", "legends, axes and texts: ", "writing 'v.png': "});
  const std::string rays = must({"render", "--source", "sphere size=12", "--show", "volume", "--size", "80x60", "-o", "v.png", "-v"}).err;
  check_order(rays, {"drawing ", "1 volume by rays through "});
  CHECK(must({"render", "--source", "sphere size=12", "--size", "80x60", "-o", "v.png"}).err.find("running") == std::string::npos);
}

TEST_CASE("--verbose: convert and run print their steps too") {
  const std::string converted = must({"convert", "--source", "sphere size=6", "-f", "statistics", "-o", "v.csv", "-v"}).err;
  check_order(converted, {"running 'sphere'", "running 'statistics'", "table of ", " and 1 row", "writing 'v.csv'"});
  must({"convert", "--source", "sphere size=6", "-o", "v.vti"});
  const std::string read = must({"info", "v.vti", "-f", "contour values=0", "-v"}).err;
  check_order(read, {"reading (step 'input')", "uniform of 216 points", "running 'contour'"});
}
