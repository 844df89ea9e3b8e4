// SPDX-License-Identifier: Apache-2.0
#include "index/minmax_bricks.h"

#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "base/random.h"
#include "support/test.h"

using namespace sg;

namespace {
template <class T>
void check_against_brute_force(std::array<size_t, 3> dims, double scale) {
  std::vector<T> v(dims[0] * dims[1] * dims[2]);
  for (size_t i = 0; i < v.size(); ++i) v[i] = T(random_unit(3, i) * scale);
  if constexpr (std::is_floating_point_v<T>)
    for (size_t i = 0; i < v.size(); i += 7) v[i] = T(NAN);
  const MinMaxBricks b = minmax_bricks(Array::from_vector(v), dims);
  for (size_t k = 0; k < b.dims[2]; ++k)
    for (size_t j = 0; j < b.dims[1]; ++j)
      for (size_t i = 0; i < b.dims[0]; ++i) {
        double lo = HUGE_VAL, hi = -HUGE_VAL;
        for (size_t z = 8 * k; z <= 8 * k + 8 && z < dims[2]; ++z)
          for (size_t y = 8 * j; y <= 8 * j + 8 && y < dims[1]; ++y)
            for (size_t x = 8 * i; x <= 8 * i + 8 && x < dims[0]; ++x) {
              const double s = double(v[x + dims[0] * (y + dims[1] * z)]);
              if (s == s) lo = std::min(lo, s), hi = std::max(hi, s);
            }
        const MinMaxBricks::Range r = b.ranges[b.id(i, j, k)];
        REQUIRE(double(r.lo) <= lo);
        REQUIRE(double(r.hi) >= hi);
        REQUIRE(double(r.lo) >= lo - 1e-6 * std::abs(lo));
        REQUIRE(double(r.hi) <= hi + 1e-6 * std::abs(hi));
      }
}
}  // namespace

TEST_CASE("min-max bricks: ranges are those of a plain loop, with the shared samples, for every type") {
  check_against_brute_force<float>({17, 9, 10}, 3);
  check_against_brute_force<double>({18, 8, 26}, 1e9);
  check_against_brute_force<uint8_t>({33, 7, 9}, 255);
  check_against_brute_force<int16_t>({9, 9, 9}, 30000);
  check_against_brute_force<int32_t>({10, 11, 12}, 2e9);
  check_against_brute_force<uint64_t>({10, 2, 12}, 1e19);
}

TEST_CASE("min-max bricks: sample 8 belongs to two cubes, and a lattice of 9 samples has one") {
  CHECK(minmax_bricks(Array::from_vector(std::vector<float>(9)), {9, 1, 1}).dims[0] == 1);
  std::vector<float> v(10);
  v[8] = 5;
  const MinMaxBricks b = minmax_bricks(Array::from_vector(v), {10, 1, 1});
  REQUIRE(b.size() == 2);
  CHECK(b.ranges[0].hi == 5);
  CHECK(b.ranges[1].hi == 5);
  CHECK(b.ranges[1].lo == 0);
}

TEST_CASE("min-max bricks: a cube of NaN alone has an empty range, infinities stay in it") {
  CHECK(minmax_bricks(Array::from_vector(std::vector<float>(27, NAN)), {3, 3, 3}).ranges[0].empty());
  const MinMaxBricks::Range r = minmax_bricks(Array::from_vector(std::vector<float>(27, INFINITY)), {3, 3, 3}).ranges[0];
  CHECK_FALSE(r.empty());
  CHECK(r.hi == INFINITY);
}

TEST_CASE("min-max bricks: the same for 1 and 8 threads; a wrong size is refused") {
  std::vector<float> v(40 * 41 * 42);
  for (size_t i = 0; i < v.size(); ++i) v[i] = float(random_unit(1, i));
  const Array a = Array::from_vector(v);
  set_thread_count(1);
  const MinMaxBricks one = minmax_bricks(a, {40, 41, 42});
  set_thread_count(8);
  const MinMaxBricks eight = minmax_bricks(a, {40, 41, 42});
  set_thread_count(0);
  CHECK(std::memcmp(one.ranges.data(), eight.ranges.data(), one.size() * sizeof(MinMaxBricks::Range)) == 0);
  CHECK(test::error_of([&] { minmax_bricks(a, {40, 41, 43}); }).find("does not fit") != std::string::npos);
  CHECK(test::error_of([&] { empty_distance({1, 1}, {3, 1, 1}); }).find("one flag per cube") != std::string::npos);
}

TEST_CASE("empty distance: equals the brute-force Chebyshev distance") {
  const std::array<size_t, 3> dims{7, 9, 5};
  std::vector<uint8_t> empty(dims[0] * dims[1] * dims[2], 1);
  for (size_t i = 0; i < empty.size(); ++i) empty[i] = random_unit(5, i) > 0.02;
  const std::vector<uint8_t> d = empty_distance(empty, dims);
  auto coordinate = [&](size_t id, size_t a) {
    return int(a == 0 ? id % dims[0] : a == 1 ? id / dims[0] % dims[1] : id / dims[0] / dims[1]);
  };
  int full = 0;
  for (size_t p = 0; p < empty.size(); ++p) {
    int best = 255;
    full += !empty[p];
    for (size_t q = 0; q < empty.size(); ++q) {
      if (empty[q]) continue;
      int far = 0;
      for (size_t a = 0; a < 3; ++a) far = std::max(far, std::abs(coordinate(p, a) - coordinate(q, a)));
      best = std::min(best, far);
    }
    REQUIRE(int(d[p]) == best);
  }
  CHECK(full > 0);
  CHECK(empty_distance({1, 1, 1}, {3, 1, 1}) == std::vector<uint8_t>{255, 255, 255});
}
