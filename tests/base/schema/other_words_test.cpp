// SPDX-License-Identifier: Apache-2.0
#include "base/schema/other_words.h"

#include <vector>

#include "support/test.h"

using namespace sg;

TEST_CASE("other words: what other programs call a parameter or a choice is told in the words used here") {
  const std::vector<std::string> contour{"field", "values", "count", "normals"};
  CHECK(same_word("isovalues", contour) == "values");
  CHECK(same_word("n", contour) == "count");
  CHECK(same_word("color_by", contour) == "field");
  CHECK(same_word("tolerance", contour).empty());
  const std::vector<std::string> modes{"composite", "maximum", "minimum", "average"};
  CHECK(same_word("MIP", modes) == "maximum");
  CHECK(other_word_hint("mip", modes) == "here it is 'maximum'; available: composite, maximum, minimum, average");
  // A slip of the pen is told as such.
  CHECK(other_word_hint("maximun", modes).starts_with("did you mean 'maximum'?"));
  const std::vector<std::string> flags{"--field", "--map", "--size"};
  CHECK(same_word("--color-by", flags) == "--field");
  CHECK(same_word("--cmap", flags) == "--map");
  CHECK(same_word("--sise", flags).empty());
}
