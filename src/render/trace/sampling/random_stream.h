// SPDX-License-Identifier: Apache-2.0
// RandomStream: as many independent numbers as a place of a path asks for, which nobody can know in advance.
#pragma once
#include <cmath>

#include "base/random.h"
#include "render/trace/sampling/unit_float.h"

namespace sg::trace {

class RandomStream {
 public:
  explicit RandomStream(uint64_t key) : key_(key) {}
  /// In [0, 1).
  float next() { return unit_float(uint32_t(random_bits(key_, count_++) >> 32)); }
  /// Of mean 1, by their density exp(-x).
  double exponential() { return -std::log1p(-double(next())); }

 private:
  uint64_t key_, count_ = 0;
};

}  // namespace sg::trace
