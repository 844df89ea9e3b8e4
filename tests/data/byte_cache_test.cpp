// SPDX-License-Identifier: Apache-2.0
#include "data/memory/byte_cache.h"

#include <algorithm>
#include <atomic>

#include "base/parallel.h"
#include "data/bricked.h"
#include "support/test.h"

using namespace sg;

namespace {
auto thing(int v, size_t bytes) {
  return [=] { return std::pair(std::make_shared<const int>(v), bytes); };
}
}  // namespace

TEST_CASE("byte cache: the one not used for longest goes first, and never beyond the limit") {
  ByteCache<int> c(100);
  for (int i = 0; i < 3; ++i) CHECK(*c.get(uint64_t(i), thing(i, 30)) == i);
  c.get(0, thing(-1, 30));  // used: now 1 is the oldest
  c.get(3, thing(3, 30));
  CHECK(c.stats().bytes == 90);
  CHECK(*c.get(0, thing(-1, 30)) == 0);
  CHECK(*c.get(1, thing(7, 30)) == 7);  // made again
  CHECK(c.stats().most <= 100);
  CHECK(c.stats().made == 5);
  const auto held = c.get(5, thing(5, 1000));  // larger than all: handed out, the only one kept
  CHECK(*held == 5);
  c.set_limit(0);
  CHECK(c.stats().bytes == 0);
  CHECK(*held == 5);
}

TEST_CASE("byte cache: an error goes to who asked, the next one tries again") {
  ByteCache<int> c(100);
  auto broken = [&] { c.get(1, []() -> std::pair<std::shared_ptr<const int>, size_t> { fail_data("torn"); }); };
  CHECK(sg::test::error_of(broken) == "torn");
  CHECK(*c.get(1, thing(4, 10)) == 4);
}

TEST_CASE("byte cache: many threads get the right things, each made once when all fit") {
  ByteCache<int> c(1000 * 8);
  std::atomic<int> made{0}, wrong{0};
  parallel_for(20000, 10, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto key = uint64_t(i * 7919 % 1000);
      const auto t = c.get(key, [&] {
        ++made;
        return std::pair(std::make_shared<const int>(int(key)), size_t(8));
      });
      wrong += *t != int(key);
    }
  });
  CHECK(made == 1000);
  CHECK(wrong == 0);
}

TEST_CASE("bricked: extremes of slabs are those of the whole, both borders of a block count, NaN does not") {
  const std::array<size_t, 3> dims{130, 65, 129};
  std::vector<float> v(dims[0] * dims[1] * dims[2]);
  for (size_t i = 0; i < v.size(); ++i) v[i] = float(i * 2654435761u % 10007);
  v[64 + 130 * (10 + 65 * 64)] = -5;  // a corner of four blocks
  for (size_t i = 128; i < 130; ++i) v[i] = NAN;
  const Array all = Array::from_vector(v);
  BlockExtremes whole(dims), slabs(dims);
  whole.add(all, 0, dims[2]);
  for (size_t k = 0; k < dims[2]; k += 20) {
    const size_t n = std::min<size_t>(20, dims[2] - k);
    slabs.add(all.slice(k * 130 * 65, (k + n) * 130 * 65), 0, n);
  }
  const auto a = whole.take(), b = slabs.take();
  REQUIRE(a.size() == 3 * 1 * 2);
  size_t lows = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    CHECK(a[i].lo == b[i].lo);
    CHECK(a[i].hi == b[i].hi);
    lows += a[i].lo == -5;
  }
  CHECK(lows == 4);
  BlockExtremes none({1, 1, 1});
  none.add(Array::from_vector(std::vector<float>{NAN}), 0, 1);
  const auto e = none.take();
  CHECK(e.size() == 1);
  CHECK(e[0].lo > e[0].hi);
}
