// SPDX-License-Identifier: Apache-2.0
#include "io/plausible.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"
#include "data/memory/memory_budget.h"

namespace sg {

namespace {
constexpr uint64_t always = uint64_t(256) << 20, times_the_file = 100;
}

uint64_t plausible_memory(uint64_t file_bytes) {
  uint64_t most = 0;
  if (__builtin_mul_overflow(file_bytes, times_the_file, &most) || __builtin_add_overflow(most, always, &most)) most = UINT64_MAX;
  return std::max<uint64_t>(most, memory_limit());
}

void check_plausible(uint64_t need, uint64_t file_bytes, const std::string& path) {
  if (need <= plausible_memory(file_bytes)) return;
  fail_data(fmt::format("a file of {} would need {} of memory", human_bytes(file_bytes), human_bytes(need)), path,
            fmt::format("if you trust the file, allow that much: --memory {}G", need / 1000000000 + 1));
}

void check_plausible(uint64_t count, uint64_t size, uint64_t file_bytes, const std::string& path) {
  uint64_t need = 0;
  check_plausible(__builtin_mul_overflow(count, size, &need) ? UINT64_MAX : need, file_bytes, path);
}

}  // namespace sg
