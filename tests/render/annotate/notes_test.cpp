// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/notes.h"

#include "render/annotate/annotate.h"
#include "support/test.h"

using namespace sg;

namespace {

// The box of all ink that notes leave on a picture of 400 x 300.
Rect ink(const std::vector<PictureNote>& notes, std::vector<Rect> taken = {}, Rect free = {0, 0, 400, 300}) {
  Image image(400, 300, 3);
  std::fill(image.pixels.begin(), image.pixels.end(), uint8_t(255));
  Overlay overlay(400, 300, false);
  draw_notes(overlay, notes, {0, 0, 400, 300}, free, 12, taken);
  overlay.put_on(image);
  int x0 = 400, y0 = 300, x1 = -1, y1 = -1;
  for (int y = 0; y < 300; ++y)
    for (int x = 0; x < 400; ++x)
      if (image.at(x, y)[1] < 128) x0 = std::min(x0, x), y0 = std::min(y0, y), x1 = std::max(x1, x), y1 = std::max(y1, y);
  return {double(x0), double(y0), double(x1 - x0 + 1), double(y1 - y0 + 1)};
}

PictureNote at(double x, double y, std::string text = "HHH", double size = 1) {
  return {std::move(text), Vec2{x, y}, NotePlace::top_left, size, std::nullopt};
}
PictureNote named(NotePlace place, std::string text = "HHH") { return {std::move(text), std::nullopt, place, 1, std::nullopt}; }

}  // namespace

TEST_CASE("notes: the middle of the text is at the shares of the picture, moved inside at its borders") {
  for (const Vec2 p : {Vec2{0.5, 0.5}, {0.25, 0.7}, {0.8, 0.2}}) {
    const Rect r = ink({at(p.x, p.y)});
    CHECK(std::abs(r.x + 0.5 * r.width - p.x * 400) < 2);
    CHECK(std::abs(r.y + 0.5 * r.height - p.y * 300) < 3);
  }
  for (const Vec2 p : {Vec2{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
    const Rect r = ink({at(p.x, p.y)});
    CHECK(std::abs(r.width - ink({at(0.5, 0.5)}).width) <= 2);  // letters are not on whole pixels
    CHECK(r.x > 0);
    CHECK(r.y > 0);
    CHECK(r.right() < 400);
    CHECK(r.bottom() < 300);
  }
  CHECK(ink({at(0.5, 0.5, "HHH", 2)}).height == doctest::Approx(2 * ink({at(0.5, 0.5)}).height).epsilon(0.15));
  // What is too long for the picture goes on in further lines, and shrinks.
  const Rect longest = ink({at(0.5, 0.5, std::string(3000, 'H'), 3)});
  CHECK(longest.x > 0);
  CHECK(longest.right() < 400);
  CHECK(longest.y > 0);
  CHECK(longest.bottom() < 300);
}

TEST_CASE("notes: named places are corners, sides and the middle of what is free, and the next place where something is") {
  using enum NotePlace;
  CHECK(ink({named(top_left)}).x < 20);
  CHECK(ink({named(top_right)}).right() > 380);
  CHECK(ink({named(bottom)}).bottom() > 280);
  const Rect middle = ink({named(center)});
  CHECK(std::abs(middle.x + 0.5 * middle.width - 200) < 2);
  CHECK(std::abs(middle.y + 0.5 * middle.height - 150) < 3);
  CHECK(ink({named(top_right)}, {}, {50, 60, 200, 100}).right() < 250);
  CHECK(ink({named(top_right)}, {}, {50, 60, 200, 100}).y > 60);
  const Rect corner{0, 0, 100, 80}, foot{0, 240, 100, 60};
  CHECK(ink({named(top_left)}, {corner}).y >= 80);
  CHECK(ink({named(bottom_left)}, {foot}).bottom() <= 240);
  // Two at one place stand one below the other.
  const Rect one = ink({named(top_left)}), two = ink({named(top_left), named(top_left)});
  CHECK(two.y == one.y);
  CHECK(two.height > 2 * one.height);
  CHECK(std::abs(two.width - one.width) <= 2);
}

TEST_CASE("notes: colours are as stated, and control characters are spelled out") {
  Image image(200, 100, 3);
  std::fill(image.pixels.begin(), image.pixels.end(), uint8_t(255));
  Annotation a;
  a.triad = false;
  PictureNote red = at(0.5, 0.5, "\u2588\u2588");
  red.color = Vec3f{1, 0, 0};
  a.notes = {red};
  annotate(image, a, Projection{.width = 200, .height = 100});
  size_t found = 0;
  for (size_t i = 0; i < image.pixels.size(); i += 3)
    found += image.pixels[i] == 255 && image.pixels[i + 1] == 0 && image.pixels[i + 2] == 0;
  CHECK(found > 50);
  CHECK(ink({at(0.5, 0.5, "a\x1b[1mb\u202e")}).width == ink({at(0.5, 0.5, "a\\x1b[1mb\\u202e")}).width);
}
