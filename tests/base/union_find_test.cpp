// SPDX-License-Identifier: Apache-2.0
#include "base/union_find.h"

#include "support/test.h"

using namespace sg;

TEST_CASE("union find: the root is the smallest member, whatever the order of joins") {
  const std::vector<std::pair<uint32_t, uint32_t>> joins{{7, 3}, {3, 5}, {8, 9}, {5, 1}, {9, 8}};
  for (bool backwards : {false, true}) {
    UnionFind<> sets(10);
    for (size_t k = 0; k < joins.size(); ++k) {
      const auto& [a, b] = joins[backwards ? joins.size() - 1 - k : k];
      sets.join(a, b);
    }
    const uint32_t roots[] = {0, 1, 2, 1, 4, 1, 6, 1, 8, 8};
    for (uint32_t i = 0; i < 10; ++i) CHECK(sets.root(i) == roots[i]);
  }
}
