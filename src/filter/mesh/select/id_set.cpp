// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/select/id_set.h"

#include <bit>

#include "base/error.h"
#include "base/parallel.h"

namespace sg {

namespace {
constexpr size_t words_per_chunk = 1 << 14;  // words per chunk
}

IdSet::IdSet(size_t universe) : bits_((universe + 63) / 64) {}

void IdSet::number() {
  const size_t words = bits_.size();
  std::vector<size_t> start((words + words_per_chunk - 1) / words_per_chunk);
  parallel_for(words, words_per_chunk, [&](size_t begin, size_t end) {
    size_t n = 0;
    for (size_t w = begin; w < end; ++w) n += count_bits(bits_[w]);
    start[begin / words_per_chunk] = n;
  });
  size_ = exclusive_scan(start);
  if (size_ > size_t(INT32_MAX)) fail_usage("more than 2^31 points would be kept", {}, "take a part of the mesh first");
  before_.resize(words);
  parallel_for(words, words_per_chunk, [&](size_t begin, size_t end) {
    auto n = uint32_t(start[begin / words_per_chunk]);
    for (size_t w = begin; w < end; ++w) {
      before_[w] = n;
      n += count_bits(bits_[w]);
    }
  });
}

std::vector<int64_t> IdSet::members() const {
  std::vector<int64_t> r(size_);
  parallel_for(bits_.size(), words_per_chunk, [&](size_t begin, size_t end) {
    for (size_t w = begin; w < end; ++w) {
      size_t at = before_[w];
      for (uint64_t left = bits_[w]; left; left &= left - 1) r[at++] = int64_t(w * 64 + size_t(std::countr_zero(left)));
    }
  });
  return r;
}

}  // namespace sg
