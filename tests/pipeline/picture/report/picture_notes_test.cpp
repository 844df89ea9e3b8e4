// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/report/picture_notes.h"

#include "pipeline/picture/picture.h"
#include "support/test.h"

using namespace sg;
using test::error_of;

TEST_CASE("note: texts with places, sizes and colours") {
  const auto notes = parse_notes("Inlet @ 0.1, 0.9; me@home @ top-right size=1.5 color=#ff0000 ;a\\;b;;");
  REQUIRE(notes.size() == 3);
  CHECK(notes[0].text == "Inlet");
  REQUIRE(notes[0].at);
  CHECK(notes[0].at->x == 0.1);
  CHECK(notes[0].at->y == 0.9);
  CHECK(notes[0].size == 1);
  CHECK(notes[1].text == "me@home");
  CHECK(!notes[1].at);
  CHECK(notes[1].place == NotePlace::top_right);
  CHECK(notes[1].size == 1.5);
  REQUIRE(notes[1].color);
  CHECK(notes[1].color->x == 1);
  CHECK(notes[2].text == "a;b");
  CHECK(notes[2].place == NotePlace::top_left);
  CHECK(parse_notes("").empty());
}

TEST_CASE("note: what is no place or no text is refused, with what would be right") {
  const auto told = [](const std::string& text) { return error_of([&] { parse_notes(text); }); };
  CHECK(told("Inlet @ 1.1,0.5").find("'1.1,0.5' is not a place in the picture") != std::string::npos);
  CHECK(told("Inlet @ nan,0.5").find("not a place") != std::string::npos);
  CHECK(told("Inlet @ 0.5").find("e.g. 0.1,0.9, or one of top-left") != std::string::npos);
  CHECK(told("Inlet @ upper").find("bottom-right") != std::string::npos);
  CHECK(told("Inlet @").find("not a place") != std::string::npos);
  CHECK(told("@ top").find("has no text") != std::string::npos);
  CHECK(told("Inlet @ top size=0").find("from 0.2 to 10") != std::string::npos);
  CHECK(told("Inlet @ top colour=red").find("did you mean 'color'") != std::string::npos);
  CHECK(told("Inlet @ top color=reddish").find("reddish") != std::string::npos);
  std::string many;
  for (int i = 0; i < 101; ++i) many += "x;";
  CHECK(told(many).find("at most 100") != std::string::npos);
}

TEST_CASE("note: written once over a picture and once over all panels; bad ones stop the picture before anything runs") {
  const auto drawn = [](const std::string& words) {
    PipelineFile file =
        parse_pipeline("sightglass: 1\nsteps:\n  a: {tangle: {size: 8}}\nshow: [{outline: {}}]\npicture: {size: 240x120" + words + "}\n",
                       "", picture_vocabulary());
    Context context;
    return make_picture(file, {}, context).image;
  };
  for (const char* panels : {"", ", views: [front, top]"}) {
    const Image plain = drawn(panels), noted = drawn(std::string(panels) + ", note: 'Inlet @ 0.5,0.5 color=#ff00ff'");
    int x0 = 240, x1 = -1;
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < 240; ++x)
        if (!std::equal(plain.at(x, y), plain.at(x, y) + 3, noted.at(x, y))) x0 = std::min(x0, x), x1 = std::max(x1, x);
    CHECK(std::abs(0.5 * (x0 + x1) - 120) < 4);
    CHECK(x1 - x0 < 60);
  }
  CHECK(error_of([&] { drawn(", note: 'Inlet @ nowhere'"); }).find("picture note") != std::string::npos);
}
