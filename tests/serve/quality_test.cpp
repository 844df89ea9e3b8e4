// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/quality.h"

#include <algorithm>

#include "support/test.h"

using namespace sg::serve;

TEST_CASE("quality: pictures of a moving view settle where they take the time that there is") {
  // A picture takes a fixed time and one for each sample.
  for (const double fixed : {0.0, 0.005, 0.02})
    for (const double whole : {0.004, 0.03, 0.1, 0.6, 3.0, 60.0}) {
      double coarse = first_coarseness;
      const auto takes = [&](double c) { return fixed + whole / (c * c); };
      for (int i = 0; i < 20; ++i) coarse = next_coarseness(coarse, takes(coarse), 0.032);
      INFO(fixed, " ", whole);
      double worst = 0, best = 16;
      for (int i = 0; i < 6; ++i) {
        worst = std::max(worst, coarse), best = std::min(best, coarse);
        coarse = next_coarseness(coarse, takes(coarse), 0.032);
      }
      CHECK((takes(worst) <= 0.032 || worst == 16));
      CHECK(worst / best <= 2);                  // it does not jump about
      if (takes(1) <= 0.016) CHECK(worst == 1);  // all pixels where that takes half of it
    }
}
