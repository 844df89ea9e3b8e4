// SPDX-License-Identifier: Apache-2.0
#include "base/random.h"

#include "support/test.h"

using namespace sg;

TEST_CASE("random: the values never change") {
  CHECK(random_bits(0, 0) == 0xa706dd2f4d197e6full);
  CHECK(random_bits(1, 2) == 0x17657d56072d6c6cull);
  static_assert(random_unit(5, 7) >= 0 && random_unit(5, 7) < 1);
}

TEST_CASE("random: units have mean 1/2, variance 1/12 and no serial correlation (4 standard errors, 100000 values)") {
  const int n = 100'000;
  for (const uint64_t seed : {0ull, 1ull, 12345678901234567ull}) {
    double sum = 0, squares = 0, lag = 0, before = 0;
    for (int i = 0; i < n; ++i) {
      const double u = random_unit(seed, uint64_t(i)) - 0.5;
      sum += u, squares += u * u, lag += u * before, before = u;
    }
    CHECK(std::abs(sum / n) < 4 * std::sqrt(1.0 / 12 / n));
    CHECK(std::abs(squares / n - 1.0 / 12) < 4 * std::sqrt(1.0 / 180 / n));
    CHECK(std::abs(lag / n) < 4 * (1.0 / 12) / std::sqrt(double(n)));
  }
}

TEST_CASE("random: neighbouring seeds and indices are independent: half of the bits differ (4 standard errors)") {
  const int n = 20'000;
  int64_t by_seed = 0, by_index = 0;
  for (uint64_t i = 0; i < n; ++i) {
    by_seed += __builtin_popcountll(random_bits(i, 3) ^ random_bits(i + 1, 3));
    by_index += __builtin_popcountll(random_bits(3, i) ^ random_bits(3, i + 1));
  }
  const double se = std::sqrt(16.0 / n);
  CHECK(std::abs(double(by_seed) / n - 32) < 4 * se);
  CHECK(std::abs(double(by_index) / n - 32) < 4 * se);
}

TEST_CASE("random: 64 equal bins pass chi-square (63 degrees of freedom, 99.99 % below 120)") {
  double bins[64] = {};
  const int n = 64'000;
  for (int i = 0; i < n; ++i) ++bins[int(random_unit(9, uint64_t(i)) * 64)];
  double chi = 0;
  for (const double b : bins) chi += (b - n / 64.0) * (b - n / 64.0) / (n / 64.0);
  CHECK(chi < 120);
  CHECK(chi > 25);  // too even would be wrong as well
}
