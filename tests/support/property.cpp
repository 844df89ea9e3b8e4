// SPDX-License-Identifier: Apache-2.0
#include "support/property.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>

namespace sg::test {

namespace {
std::atomic<uint64_t> all_compared, all_over, all_beside;
}

void count_pixels(uint64_t compared, uint64_t over, uint64_t beside) {
  [[maybe_unused]] static const int told = std::atexit([] {
    fmt::print("property: {} pixels compared, {} over what is allowed, {} within it only just beside\n", all_compared.load(),
               all_over.load(), all_beside.load());
  });
  all_compared += compared, all_over += over, all_beside += beside;
}

std::vector<uint64_t> property_seeds(int cases) {
  uint64_t first = 1;
  if (const char* seed = std::getenv("SG_PROPERTY_SEED")) first = std::strtoull(seed, nullptr, 10);
  if (const char* count = std::getenv("SG_PROPERTY_CASES")) cases = std::atoi(count);
  std::vector<uint64_t> seeds(size_t(std::max(cases, 0)));
  for (uint64_t& seed : seeds) seed = first++;
  return seeds;
}

}  // namespace sg::test
