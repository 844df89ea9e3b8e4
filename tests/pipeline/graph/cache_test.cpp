// SPDX-License-Identifier: Apache-2.0
#include "pipeline/graph/cache.h"

#include <atomic>
#include <thread>

#include "pipeline/operation/test_operations.h"
#include "support/test.h"

using namespace sg;

namespace {
Key key_of(uint64_t n) { return {n, n}; }
/// `bytes` / 8 doubles on a line.
DatasetPtr sized(size_t bytes) { return test::line_of(bytes / 8); }
}  // namespace

TEST_CASE("cache: bytes of data count each buffer once") {
  const DatasetPtr one = sized(800);
  CHECK(data_bytes(one) == 800);
  DatasetParts parts = one->parts();
  parts.fields.add({"same", Association::point, one->fields()[0].array, "", Role::none});
  parts.fields.add({"half", Association::whole, one->fields()[0].array.slice(0, 50), "", Role::none});
  const DatasetPtr shared = make_dataset(parts);
  CHECK(data_bytes(shared) == 800);
  auto c = std::make_shared<Collection>();
  c->parts = {{"a", one}, {"b", shared}, {"c", sized(80)}};
  CHECK(data_bytes(CollectionPtr(c)) == 880);

  SurfaceMesh m;
  m.points.xyz = Array::from_vector<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  m.polygons.fixed = 3;
  m.polygons.connectivity = Array::from_vector<int32_t>({0, 1, 2});
  CHECK(data_bytes(make_dataset(m)) == 36 + 12);
  auto t = std::make_shared<Table>();
  t->columns.push_back({"x", Association::whole, Array::from_vector<float>({1, 2}), "", Role::none});
  CHECK(data_bytes(TablePtr(t)) == 8);
}

TEST_CASE("cache: the least recently used goes when the bytes are too many") {
  Cache cache(1000);
  Context context;
  for (uint64_t i = 1; i <= 3; ++i) cache.find_or_compute(key_of(i), context, [] { return Data(sized(320)); });
  CHECK(cache.bytes() == 960);
  CHECK(cache.find(key_of(1)));  // now 2 is the oldest
  cache.find_or_compute(key_of(4), context, [] { return Data(sized(320)); });
  CHECK(cache.bytes() == 960);
  CHECK(cache.find(key_of(1)));
  CHECK_FALSE(cache.find(key_of(2)));
  CHECK(cache.find(key_of(3)));
  cache.set_limit(400);
  CHECK(cache.size() == 1);
  CHECK(cache.find(key_of(3)));
  CHECK(*cache.peek(key_of(3)) == 320);
  CHECK_FALSE(cache.peek(key_of(1)));
  cache.clear();
  CHECK(cache.bytes() == 0);
}

TEST_CASE("cache: results that share a buffer are charged for it once, and until the last of them goes") {
  Cache cache(1000);
  Context context;
  DatasetPtr big = sized(800);
  cache.find_or_compute(key_of(1), context, [&] { return Data(big); });
  DatasetParts parts = big->parts();
  parts.fields.add({"x", Association::point, Array::from_vector(std::vector<uint8_t>(100, 1)), "", Role::none});
  cache.find_or_compute(key_of(2), context, [&] { return Data(make_dataset(parts)); });
  CHECK(cache.bytes() == 900);
  CHECK(cache.size() == 2);
  cache.set_limit(899);  // 1 goes, its buffer stays with 2; so 2 has to go as well
  CHECK(cache.bytes() == 0);
}

TEST_CASE("cache: a result larger than the limit is not kept and pushes nothing out") {
  Cache cache(1000);
  Context context;
  cache.find_or_compute(key_of(1), context, [] { return Data(sized(320)); });
  cache.find_or_compute(key_of(2), context, [] { return Data(sized(8000)); });
  CHECK(cache.find(key_of(1)));
  CHECK_FALSE(cache.find(key_of(2)));
}

TEST_CASE("cache: with limit 0 nothing is kept, but what somebody holds is found") {
  Cache cache(0);
  Context context;
  Data held = cache.find_or_compute(key_of(1), context, [] { return Data(sized(80)); });
  std::weak_ptr<const Dataset> watch = std::get<DatasetPtr>(held);
  CHECK(std::get<DatasetPtr>(*cache.find(key_of(1))) == std::get<DatasetPtr>(held));
  held = DatasetPtr();
  CHECK(watch.expired());
  CHECK_FALSE(cache.find(key_of(1)));
  for (uint64_t i = 0; i < 1000; ++i) cache.find_or_compute(key_of(i), context, [] { return Data(sized(80)); });  // sweeps the dead
  CHECK(cache.size() == 0);
}

TEST_CASE("cache: eight threads that ask at once compute once; after an error another one tries") {
  Cache cache(1 << 20);
  std::atomic<int> computed{0}, failed{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i)
    threads.emplace_back([&] {
      Context context;
      try {
        cache.find_or_compute(key_of(1), context, [&]() -> Data {
          if (computed++ == 0) {
            std::this_thread::sleep_for(std::chrono::milliseconds(30));
            fail_data("first one fails");
          }
          return sized(80);
        });
      } catch (const Error&) {
        ++failed;
      }
    });
  for (std::thread& t : threads) t.join();
  CHECK(computed == 2);
  CHECK(failed == 1);
}

TEST_CASE("cache: one who waits for another thread's result stops when cancelled") {
  Cache cache(1 << 20);
  std::atomic<bool> started{false}, go{false};
  std::thread slow([&] {
    Context context;
    cache.find_or_compute(key_of(1), context, [&]() -> Data {
      started = true;
      while (!go) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return sized(80);
    });
  });
  while (!started) std::this_thread::yield();
  Context context;
  context.cancel();
  CHECK(test::error_of([&] { cache.find_or_compute(key_of(1), context, [] { return Data(sized(80)); }); }) == "cancelled");
  go = true;
  slow.join();
  CHECK(cache.find(key_of(1)));
}
