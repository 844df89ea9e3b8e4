// SPDX-License-Identifier: Apache-2.0
// Textures of flows from the command line.
#include "base/file/file.h"
#include "image/codec.h"
#include "program.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

TEST_CASE("render: a parameter that asks for the time gets it, and the waves of a texture come round") {
  const std::string out = temp_folder() + "wave_{n}.png";
  const auto r = sightglass({"render", "-s", "taylor_green size=17", "-f", "lic resolution=64 kernel=ripple phase={t}", "--show",
                             "surface field=lic map=gray", "--times", "0:1:3", "--size", "160x120", "-o", out});
  INFO(r.err);
  REQUIRE(r.status == 0);
  const Image a = read_png(temp_folder() + "wave_000.png"), b = read_png(temp_folder() + "wave_001.png"),
              c = read_png(temp_folder() + "wave_002.png");
  CHECK(a.pixels == c.pixels);
  CHECK(a.pixels != b.pixels);
}
