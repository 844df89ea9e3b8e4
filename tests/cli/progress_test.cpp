// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include "support/test.h"

using namespace sg;

TEST_CASE("progress: the rest is told once it can be estimated") {
  CHECK(progress_text(0.45, "drawing", 10) == " 45% drawing, 13 s left");
  CHECK(progress_text(0.5, "drawing", 100) == " 50% drawing, 2 min left");
  CHECK(progress_text(0.5, "drawing", 7200) == " 50% drawing, 2.0 h left");
  CHECK(progress_text(0.01, "reading", 100) == "  1% reading");
  CHECK(progress_text(0.5, "reading", 1) == " 50% reading");
  CHECK(progress_text(1, std::string(100, 'x'), 0).size() == 5 + 60);
}
