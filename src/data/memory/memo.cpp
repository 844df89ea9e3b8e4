// SPDX-License-Identifier: Apache-2.0
#include "data/memory/memo.h"

namespace sg {

int Memo::asked(const std::string& key) {
  const std::lock_guard lock(mutex_);
  return counts_[key]++;
}

size_t Memo::bytes() const {
  const std::lock_guard lock(mutex_);
  size_t sum = 0;
  for (const auto& [key, entry] : entries_) sum += entry.bytes;
  return sum;
}

}  // namespace sg
