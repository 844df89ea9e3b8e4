// SPDX-License-Identifier: Apache-2.0
// A set of ids that numbers its members: an eighth of a byte per possible id, ranks in constant time.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "base/bits.h"

namespace sg {

/// Usage: add() from any thread, then number(), then rank(). Members are ranked by id, so the order of adding never matters.
class IdSet {
 public:
  explicit IdSet(size_t universe);
  /// Safe from several threads at once.
  void add(size_t id) {
    uint64_t& word = bits_[id >> 6];
    const uint64_t bit = uint64_t(1) << (id & 63);
    if (!(__atomic_load_n(&word, __ATOMIC_RELAXED) & bit)) __atomic_fetch_or(&word, bit, __ATOMIC_RELAXED);
  }
  /// Counts; call once after the last add(). Throws Error(usage) above 2^31-1 members, which surfaces cannot number.
  void number();
  bool has(size_t id) const { return bits_[id >> 6] >> (id & 63) & 1; }
  size_t size() const { return size_; }
  /// Place of a member among the members in ascending order.
  uint32_t rank(size_t id) const {
    const uint64_t below = bits_[id >> 6] & ((uint64_t(1) << (id & 63)) - 1);
    return before_[id >> 6] + count_bits(below);
  }
  /// All members in ascending order. Parallel.
  std::vector<int64_t> members() const;

 private:
  std::vector<uint64_t> bits_;
  std::vector<uint32_t> before_;
  size_t size_ = 0;
};

}  // namespace sg
