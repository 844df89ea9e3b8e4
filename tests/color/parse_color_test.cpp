// SPDX-License-Identifier: Apache-2.0
#include "color/parse_color.h"

#include <doctest/doctest.h>
#include <fmt/core.h>

#include <algorithm>
#include <iterator>

#include "color/css_colors.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("colours as text: all names of CSS, in any case") {
  CHECK(std::size(css_colors) == 148);
  CHECK(std::is_sorted(std::begin(css_colors), std::end(css_colors), [](const CssColor& a, const CssColor& b) { return a.name < b.name; }));
  for (const CssColor& c : css_colors) {
    CAPTURE(c.name);
    CHECK(color_text(parse_color(c.name, "")) == fmt::format("#{:06x}", c.rgb));
  }
  CHECK(color_text(parse_color("RebeccaPurple", "")) == "#663399");
  // Twice the same colour: both spellings of grey, aqua and cyan, fuchsia and magenta.
  for (const CssColor& c : css_colors)
    if (const size_t at = c.name.find("gray"); at != c.name.npos) {
      std::string other(c.name);
      other[at + 2] = 'e';
      CHECK(color_text(parse_color(other, "")) == color_text(parse_color(c.name, "")));
    }
  CHECK(color_text(parse_color("aqua", "")) == color_text(parse_color("cyan", "")));
  CHECK(color_text(parse_color("fuchsia", "")) == color_text(parse_color("magenta", "")));
}

TEST_CASE("colours as text: numbers, and what else there might be") {
  CHECK(color_text(parse_color("#1af", "")) == "#11aaff");
  CHECK(color_text(parse_color(" 0.2, 0.4,1 ", "")) == "#3366ff");
  CHECK(test::error_of([] {
          parse_color("stelblue", "background");
        }).find("background: 'stelblue' is not a colour; did you mean 'steelblue'?") == 0);
  for (const char* wrong : {"", "#12345", "#gggggg", "1,2,3", "0,0", "0,0,nan"}) CHECK_THROWS_AS(parse_color(wrong, ""), Error);
}
