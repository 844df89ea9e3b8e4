// SPDX-License-Identifier: Apache-2.0
// lookdev: balls of materials on a sheet, and names of materials that are none.
#include <string>

#include "base/file/file.h"
#include "cli/program.h"
#include "image/codec.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using test::sightglass;

namespace {

Image lookdev_sheet(const std::string& name) { return read_png(test::temp_folder() + name); }

/// Red by blue in the middle of a picture.
double warmth(const Image& image) {
  double red = 0, blue = 0;
  for (int y = image.height * 2 / 5; y < image.height * 3 / 5; ++y)
    for (int x = image.width * 2 / 5; x < image.width * 3 / 5; ++x) red += image.at(x, y)[0], blue += image.at(x, y)[2];
  return red / blue;
}

}  // namespace

TEST_CASE("lookdev: a ball of one material is a picture, several are a sheet") {
  const test::Ran ran = sightglass({"lookdev", "gold", "--noise", "1", "-o", "gold.png"});
  CHECK(ran.status == 0);
  CHECK(contains(ran.out + ran.err, "gold.png: 1 materials"));
  const Image gold = lookdev_sheet("gold.png");
  CHECK(gold.width == 240);
  CHECK(gold.height == 240);
  CHECK(warmth(gold) > 1.3);
  REQUIRE(sightglass({"lookdev", "chromium", "--noise", "1", "-q", "-o", "chromium.png"}).out.empty());
  CHECK(warmth(lookdev_sheet("chromium.png")) < 1.2);
  REQUIRE(sightglass({"lookdev", "gold", "matte", "--noise", "1", "-q", "-o", "sheet.png"}).status == 0);
  CHECK(lookdev_sheet("sheet.png").width > 2 * 240);
}

TEST_CASE("lookdev: unknown materials and numbers out of range are refused before anything is drawn") {
  const auto refused = [](const std::vector<std::string>& args, const char* text) {
    const test::Ran ran = sightglass(args);
    CAPTURE(ran.err);
    CHECK(ran.status == 2);
    CHECK(contains(ran.err, text));
  };
  refused({"lookdev", "gald", "-o", "none.png"}, "there is no material 'gald'; did you mean 'gold'?");
  refused({"lookdev", "gold", "--noise", "7", "-o", "none.png"}, "--noise");
  CHECK_FALSE(file_exists(test::temp_folder() + "none.png"));
}
