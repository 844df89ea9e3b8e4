// SPDX-License-Identifier: Apache-2.0
#include "support/property.h"

#include <algorithm>
#include <cstdlib>

namespace sg::test {

std::vector<uint64_t> property_seeds(int cases) {
  uint64_t first = 1;
  if (const char* seed = std::getenv("SG_PROPERTY_SEED")) first = std::strtoull(seed, nullptr, 10);
  if (const char* count = std::getenv("SG_PROPERTY_CASES")) cases = std::atoi(count);
  std::vector<uint64_t> seeds(size_t(std::max(cases, 0)));
  for (uint64_t& seed : seeds) seed = first++;
  return seeds;
}

}  // namespace sg::test
