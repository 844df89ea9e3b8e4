// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/contact_sheet.h"

#include <algorithm>

#include "support/test.h"

using namespace sg;

namespace {

CaptionedImage red(int width, int height) {
  CaptionedImage p{Image(width, height, 3), "a caption"};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) p.image.at(x, y)[0] = 255;
  return p;
}

/// The box of what is red, as first and last column and row.
struct Box {
  int x0 = 1 << 20, x1 = -1, y0 = 1 << 20, y1 = -1;
};
Box box_of_red(const Image& sheet) {
  Box b;
  for (int y = 0; y < sheet.height; ++y)
    for (int x = 0; x < sheet.width; ++x)
      if (const uint8_t* p = sheet.at(x, y); p[0] == 255 && p[1] == 0)
        b.x0 = std::min(b.x0, x), b.x1 = std::max(b.x1, x), b.y0 = std::min(b.y0, y), b.y1 = std::max(b.y1, y);
  return b;
}

}  // namespace

TEST_CASE("contact sheet: cells are as high as the tallest picture, at most square, and pictures keep their proportions") {
  const auto fills = [](const CaptionedImage& p, int wide, int high) {
    const Image sheet = contact_sheet({p}, 4, 90);
    const Box b = box_of_red(sheet);
    CHECK(b.x1 - b.x0 + 1 == wide);
    CHECK(b.y1 - b.y0 + 1 == high);
    CHECK(sheet.width == 90 + 2 * 12);
  };
  fills(red(320, 180), 90, 51);
  fills(red(50, 50), 90, 90);
  fills(red(50, 100), 45, 90);
  // A wide picture stands in the middle of a cell that another makes square.
  const Image both = contact_sheet({red(50, 50), red(180, 90)}, 1, 90);
  CHECK(both.height == 12 + 2 * (90 + 26 + 12));
  CHECK(contact_sheet({}, 3, 90).width > 0);
}
