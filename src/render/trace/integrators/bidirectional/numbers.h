// SPDX-License-Identifier: Apache-2.0
// Where a path takes its random numbers from: a sampler, or a point of the space of all numbers, in which Metropolis walks.
#pragma once
#include <cstdint>

#include "render/trace/sampling/sampler.h"

namespace sg::trace {

class Numbers {
 public:
  virtual ~Numbers() = default;
  /// In [0, 1).
  virtual float next() = 0;
  virtual Vec2f next2() = 0;
  /// Of one number, for a RandomStream.
  virtual uint64_t stream() = 0;
};

class SamplerNumbers : public Numbers {
 public:
  explicit SamplerNumbers(Sampler& sampler) : sampler_(sampler) {}
  float next() override { return sampler_.next(); }
  Vec2f next2() override { return sampler_.next2(); }
  uint64_t stream() override { return sampler_.stream(); }

 private:
  Sampler& sampler_;
};

}  // namespace sg::trace
