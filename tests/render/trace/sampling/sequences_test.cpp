// SPDX-License-Identifier: Apache-2.0
#include <set>
#include <vector>

#include "base/random.h"
#include "render/trace/sampling/owen.h"
#include "render/trace/sampling/radical_inverse.h"
#include "render/trace/sampling/sobol.h"
#include "render/trace/sampling/unit_float.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using doctest::Approx;

namespace {

using Points = std::vector<Vec2>;

// Warnock's closed form of the L2 star discrepancy in two dimensions.
double l2_star(const Points& p) {
  const double n = double(p.size());
  double single = 0, pairs = 0;
  for (const Vec2 a : p) {
    single += (1 - a.x * a.x) * (1 - a.y * a.y) / 4;
    for (const Vec2 b : p) pairs += (1 - std::max(a.x, b.x)) * (1 - std::max(a.y, b.y));
  }
  return std::sqrt(1.0 / 9 - 2 / n * single + pairs / (n * n));
}

Points points(int n, auto f) {
  Points p;
  for (int i = 0; i < n; ++i) p.push_back(f(i));
  return p;
}

Vec2 sobol_point(uint64_t i) { return {sobol_first(i) * 0x1p-32, sobol_second(i) * 0x1p-32}; }

// Whether each of the 2^k boxes of every shape 2^-a by 2^(a-k) holds one of 2^k points.
bool is_net(const std::vector<std::pair<uint32_t, uint32_t>>& p, int k) {
  for (int a = 0; a <= k; ++a) {
    std::set<uint64_t> boxes;
    for (const auto& [x, y] : p) boxes.insert((uint64_t(x) >> (32 - a)) << 32 | uint64_t(y) >> (32 - (k - a)));
    if (boxes.size() != p.size()) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("sequences: the first radical inverses in bases 2 and 3") {
  const double two[] = {0, .5, .25, .75, .125, .625}, three[] = {1 / 3., 2 / 3., 1 / 9., 4 / 9., 7 / 9., 2 / 9.};
  for (int i = 0; i < 6; ++i) {
    CHECK(radical_inverse(2, uint64_t(i)) == two[i]);
    CHECK(radical_inverse(3, uint64_t(i + 1)) == Approx(three[i]).epsilon(1e-15));
  }
  CHECK(prime(0) == 2);
  CHECK(prime(24) == 97);
  CHECK(prime(127) == 719);
  CHECK(radical_inverse(2, UINT64_MAX) < 1);
}

TEST_CASE("sequences: the first points of Sobol, and its second coordinate by direction numbers") {
  const Vec2 first[] = {{0, 0}, {.5, .5}, {.25, .75}, {.75, .25}, {.125, .625}};
  for (uint64_t i = 0; i < 5; ++i) CHECK(sobol_point(i) == first[i]);
  // The polynomial x + 1: v_(j+1) = v_j xor v_j / 2, here of 64 bits so that none is lost.
  for (const uint64_t index : {uint64_t(7), uint64_t(1000), uint64_t(0x123456789abcdef), uint64_t(UINT64_MAX)}) {
    uint64_t direction = 1ull << 63, sum = 0;
    for (int j = 0; j < 64; ++j, direction ^= direction >> 1)
      if (index >> j & 1) sum ^= direction;
    CHECK(sobol_second(index) == uint32_t(sum >> 32));
  }
}

TEST_CASE("sequences: L2 star discrepancies of 64 points") {
  CHECK(l2_star(points(64, [](int i) {
          return Vec2{radical_inverse(2, uint64_t(i)), radical_inverse(3, uint64_t(i))};
        })) == Approx(.0164094).epsilon(5e-6));
  CHECK(l2_star(points(64, [](int i) { return sobol_point(uint64_t(i)); })) == Approx(.0128698).epsilon(5e-6));
  CHECK(l2_star(points(64, [](int i) { return Vec2{i / 64., radical_inverse(2, uint64_t(i))}; })) == Approx(.0212052).epsilon(5e-6));
  CHECK(l2_star(points(64, [](int i) { return Vec2{(i % 8 + .5) / 8, (i / 8 + .5) / 8}; })) == Approx(.0295633).epsilon(5e-6));
}

TEST_CASE("sequences: every aligned block of 2^k points of Sobol is a net, in any order and scrambling") {
  for (int k = 0; k <= 10; ++k)
    for (const uint32_t seed : {0u, 1u, 0xdeadbeefu})
      for (const uint64_t block : {0ull, 1ull, 5ull}) {
        std::vector<std::pair<uint32_t, uint32_t>> plain, scrambled;
        for (uint64_t i = block << k; i < (block + 1) << k; ++i) {
          plain.emplace_back(sobol_first(i), sobol_second(i));
          const uint32_t at = owen_scrambled(uint32_t(i), seed ^ 77);
          scrambled.emplace_back(owen_scrambled(sobol_first(at), seed), owen_scrambled(sobol_second(at), seed + 1));
        }
        REQUIRE(is_net(plain, k));
        REQUIRE(is_net(scrambled, k));
      }
}

TEST_CASE("sequences: Owen scrambling is nested, and each bit flips for half of the seeds (4 standard errors)") {
  const int n = 20'000;
  int flips[32] = {};
  for (int s = 0; s < n; ++s) {
    const uint64_t drawn = random_bits(3, uint64_t(s));
    const uint32_t v = uint32_t(drawn), seed = uint32_t(drawn >> 32), w = owen_scrambled(v, seed);
    for (int b = 0; b < 32; ++b) {
      flips[b] += int((v ^ w) >> b & 1);
      // Changing bit b leaves those above it as they were.
      if (s < 200) CHECK(((owen_scrambled(v ^ 1u << b, seed) ^ w) >> b) == 1);
    }
  }
  for (const int f : flips) CHECK(std::abs(f - n / 2) < 4 * std::sqrt(n / 4.));
}

TEST_CASE("sequences: scrambled radical inverses keep one point in each interval, also of the trailing zeros") {
  for (const uint32_t base : {2u, 3u, 5u, 719u})
    for (uint32_t count = base; count <= std::max(base, 729u); count *= base)
      for (const uint32_t first : {0u, count}) {
        std::set<uint32_t> met;
        for (uint32_t i = first; i < first + count; ++i) met.insert(uint32_t(double(owen_radical_inverse(base, i, 2 * count, 5)) * count));
        CHECK(met.size() == count);
      }
}

TEST_CASE("sequences: permuted is a permutation, and brings each place everywhere equally often (4 standard errors)") {
  for (const uint32_t count : {1u, 2u, 3u, 17u, 64u, 1000u}) {
    std::set<uint32_t> met;
    for (uint32_t i = 0; i < count; ++i) met.insert(permuted(i, count, random_bits(9, count)));
    CHECK(met.size() == count);
    CHECK(*met.rbegin() == count - 1);
  }
  const uint32_t count = 5;
  const int n = 20'000;
  int there[count][count] = {};
  for (int s = 0; s < n; ++s)
    for (uint32_t i = 0; i < count; ++i) ++there[i][permuted(i, count, random_bits(1, uint64_t(s)))];
  for (const auto& row : there)
    for (const int k : row) CHECK(std::abs(k - n / 5.) < 4 * std::sqrt(n * .2 * .8));
}

TEST_CASE("sequences: two orders know nothing of each other: products of signs vary by count / (count - 1), as with shuffled cards") {
  const int n = 20'000;
  for (const uint32_t count : {4u, 8u, 16u, 32u, 64u, 256u})
    for (const uint32_t bit : {0u, 1u}) {
      double squares = 0;
      for (int s = 0; s < n; ++s) {
        double sum = 0;
        for (uint32_t i = 0; i < count; ++i)
          sum += ((permuted(i, count, random_bits(1, uint64_t(s))) ^ permuted(i, count, random_bits(2, uint64_t(s)))) >> bit & 1) ? -1 : 1;
        squares += sum * sum / count / n;
      }
      CAPTURE(count);
      // The square of a sum of signs has a standard deviation of at most the root of 2, by its mean.
      CHECK(squares == Approx(count / (count - 1.)).epsilon(4 * std::sqrt(2. / n)));
    }
}

TEST_CASE("sequences: units are below one") {
  CHECK(unit_float(UINT32_MAX) < 1);
  CHECK(below_one(1 - 1e-12) < 1);
  CHECK(below_one(1.0) < 1);
}
