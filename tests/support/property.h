// SPDX-License-Identifier: Apache-2.0
// Property tests: what holds for every input is tried on random ones, from a fixed seed in ./test, from fresh seeds by tools/property.
//
//   TEST_CASE("property: clip and its complement add up") {
//     for (uint64_t seed : test::property_seeds(40)) {
//       CAPTURE(seed);
//       Random random(seed); ...
//
// Each case depends on its own seed alone, so that a finding is repeated by SG_PROPERTY_SEED=<its seed> SG_PROPERTY_CASES=1.
#pragma once
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "base/random.h"

namespace sg::test {

/// Seeds of the cases to try: 1..cases, or $SG_PROPERTY_CASES of them from $SG_PROPERTY_SEED on.
std::vector<uint64_t> property_seeds(int cases);

/// Counts pixels that a property test compared: all, those beyond what is allowed, and those within it only where the truth just beside
/// them is taken. The program prints the sums in one line when it ends.
void count_pixels(uint64_t compared, uint64_t over, uint64_t beside);

/// A stream of random choices that follow from a seed.
class Random {
 public:
  explicit Random(uint64_t seed) : seed_(seed) {}
  /// Uniform in [0, 1).
  double unit() { return random_unit(seed_, next_++); }
  /// Uniform in [low, high).
  double in(double low, double high) { return low + (high - low) * unit(); }
  /// A whole number of low..high, both included.
  int whole(int low, int high) { return low + int(unit() * (high - low + 1)); }
  /// True in this share of the calls.
  bool chance(double share) { return unit() < share; }
  /// One of the values.
  template <class T>
  T one_of(std::initializer_list<T> values) {
    return values.begin()[whole(0, int(values.size()) - 1)];
  }
  /// Uniform in the logarithm; low and high are positive.
  double magnitude(double low, double high) { return std::exp(in(std::log(low), std::log(high))); }

 private:
  uint64_t seed_, next_ = 0;
};

}  // namespace sg::test
