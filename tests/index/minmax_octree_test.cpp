// SPDX-License-Identifier: Apache-2.0
#include "index/minmax_octree.h"

#include <algorithm>
#include <cstring>
#include <set>

#include "base/parallel.h"
#include "base/random.h"
#include "support/test.h"

using namespace sg;

namespace {

Array wavy(std::array<size_t, 3> d, bool holes) {
  float* v = nullptr;
  Array a = Array::make<float>(d[0] * d[1] * d[2], 1, &v);
  for (size_t k = 0, p = 0; k < d[2]; ++k)
    for (size_t j = 0; j < d[1]; ++j)
      for (size_t i = 0; i < d[0]; ++i, ++p) {
        v[p] = float(std::sin(0.1 * double(i)) + std::cos(0.13 * double(j)) * std::sin(0.07 * double(k)) + 0.1 * random_unit(1, p));
        if (holes && (i < 20 || random_unit(2, p) < 0.1)) v[p] = NAN;
      }
  return a;
}

using Cubes = std::vector<std::array<size_t, 3>>;
Cubes found(const MinMaxOctree& t, double lo, double hi) {
  Cubes r;
  t.meeting(lo, hi, [&](size_t i, size_t j, size_t k) { r.push_back({i, j, k}); });
  return r;
}

}  // namespace

TEST_CASE("minmax octree: exactly the cubes whose range meets the question are found, each once") {
  for (bool holes : {false, true})
    for (std::array<size_t, 3> d : {std::array<size_t, 3>{70, 41, 29}, {9, 9, 9}, {200, 1, 3}, {1, 1, 1}}) {
      const Array a = wavy(d, holes);
      const MinMaxBricks bricks = minmax_bricks(a, d);
      const MinMaxOctree tree = minmax_octree(a, d);
      for (auto [lo, hi] : {std::pair{0.3, 0.3}, {-0.5, 0.1}, {-9.0, 9.0}, {1.6, 2.5}, {5.0, 6.0}, {0.2, 0.1}, {double(NAN), 1.0}}) {
        std::set<std::array<size_t, 3>> expected;
        for (size_t k = 0; k < bricks.dims[2]; ++k)
          for (size_t j = 0; j < bricks.dims[1]; ++j)
            for (size_t i = 0; i < bricks.dims[0]; ++i) {
              const auto r = bricks.ranges[bricks.id(i, j, k)];
              if (lo <= hi && !r.empty() && double(r.lo) <= hi && double(r.hi) >= lo) expected.insert({i, j, k});
            }
        const Cubes got = found(tree, lo, hi);
        CHECK(got.size() == expected.size());
        CHECK(std::set<std::array<size_t, 3>>(got.begin(), got.end()) == expected);
      }
    }
}

TEST_CASE("minmax octree: a cell that an isovalue passes lies in a cube that is found") {
  const std::array<size_t, 3> d{40, 33, 27};
  const Array a = wavy(d, false);
  const MinMaxOctree tree = minmax_octree(a, d);
  std::set<std::array<size_t, 3>> cubes;
  tree.containing(0.25, [&](size_t i, size_t j, size_t k) { cubes.insert({i, j, k}); });
  size_t passed = 0, missed = 0;
  const auto v = a.view<float>();
  for (size_t k = 0; k + 1 < d[2]; ++k)
    for (size_t j = 0; j + 1 < d[1]; ++j)
      for (size_t i = 0; i + 1 < d[0]; ++i) {
        float lo = HUGE_VALF, hi = -HUGE_VALF;
        for (size_t c = 0; c < 8; ++c) {
          const float f = v[(i + (c & 1)) + d[0] * ((j + (c >> 1 & 1)) + d[1] * (k + (c >> 2)))];
          lo = std::min(lo, f), hi = std::max(hi, f);
        }
        if (lo > 0.25f || hi < 0.25f) continue;
        ++passed;
        missed += !cubes.count({i / 8, j / 8, k / 8});
      }
  CHECK(passed > 1000);
  CHECK(missed == 0);
  CHECK(cubes.size() < tree.levels[0].ranges.size());
}

TEST_CASE("minmax octree: NaN alone is found by no question, and the top knows the range of all") {
  float* v = nullptr;
  Array a = Array::make<float>(1000, 1, &v);
  std::fill_n(v, 1000, NAN);
  CHECK(found(minmax_octree(a, {10, 10, 10}), -HUGE_VAL, HUGE_VAL).empty());
  CHECK(minmax_octree(a, {10, 10, 10}).all().empty());
  v[999] = 7;
  const MinMaxOctree one = minmax_octree(a, {10, 10, 10});
  CHECK(one.all().lo == 7);
  CHECK(one.all().hi == 7);
  CHECK(found(one, 7, 7) == Cubes{{1, 1, 1}});
}

TEST_CASE("minmax octree: the same bytes with 1 and 8 threads") {
  const std::array<size_t, 3> d{150, 60, 70};
  const Array a = wavy(d, true);
  set_thread_count(1);
  const MinMaxOctree one = minmax_octree(a, d);
  set_thread_count(8);
  const MinMaxOctree eight = minmax_octree(a, d);
  set_thread_count(0);
  REQUIRE(one.levels.size() == eight.levels.size());
  for (size_t l = 0; l < one.levels.size(); ++l)
    CHECK(std::memcmp(one.levels[l].ranges.data(), eight.levels[l].ranges.data(),
                      one.levels[l].ranges.size() * sizeof(MinMaxBricks::Range)) == 0);
}

TEST_CASE("minmax octree: an array that does not fit the dims is refused") {
  CHECK(test::error_of([] {
          minmax_octree(Array::from_vector(std::vector<float>(7)), {2, 2, 2});
        }).find("does not fit") != std::string::npos);
}
