// SPDX-License-Identifier: Apache-2.0
#include "base/text/time_text.h"

#include "support/test.h"

using namespace sg;

TEST_CASE("time in texts: short, or in a format") {
  CHECK(with_time("t = {t}", 3.25) == "t = 3.25");
  CHECK(with_time("{t:.2f} s, {t:.0f}", 1.0 / 3) == "0.33 s, 0");
  CHECK(with_time("{title} {t", 1) == "{title} {t");
  CHECK(with_time("{t}{t}", 7) == "77");
  CHECK(has_time_mark("a {t:.1f}"));
  CHECK_FALSE(has_time_mark("{time}"));
  CHECK_FALSE(has_time_mark(""));
  CHECK(test::error_of([] { with_time("{t:what}", 1); }).size() > 0);
}

TEST_CASE("time in texts: words in braces that nothing stands for") {
  CHECK(unknown_mark("at {time}") == "{time}");
  CHECK(unknown_mark("{t} of {n} {count} {name} {t:.2f}") == "");
  CHECK(unknown_mark("set {1, 2} and {}") == "");
  CHECK(unknown_mark("{never closed") == "");
}
