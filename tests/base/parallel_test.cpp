// SPDX-License-Identifier: Apache-2.0
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <thread>

#include <fmt/core.h>

#include "base/context.h"
#include "base/random.h"
#include "support/test.h"

using namespace sg;

namespace {
struct Threads {
  explicit Threads(int n) { set_thread_count(n); }
  ~Threads() { set_thread_count(0); }
};
}  // namespace

TEST_CASE("parallel_for: every index once, chunk borders from n and grain alone") {
  for (const int threads : {1, 2, 8}) {
    const Threads use(threads);
    CHECK(thread_count() == threads);
    for (const size_t n : {0, 1, 7, 1000}) {
      std::vector<int> seen(n, 0);
      std::vector<size_t> ends(n, 0);
      parallel_for(n, 64, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) ++seen[i], ends[i] = end;
      });
      for (size_t i = 0; i < n; ++i) {
        REQUIRE(seen[i] == 1);
        REQUIRE(ends[i] == std::min(n, (i / 64 + 1) * 64));
      }
    }
  }
}

TEST_CASE(
    "parallel_for: who waits for an inner loop begins nothing else meanwhile: locks and call_once around it cannot lock themselves out") {
  const Threads use(8);  // on fewer than three cores no thread waits while two others work
  std::atomic<int> within_itself{0}, done{0};
  parallel_for(64, 1, [&](size_t i, size_t) {
    thread_local int depth = 0;
    within_itself += depth > 0;
    ++depth;
    parallel_for(32, 1, [&](size_t k, size_t) {
      const auto until = std::chrono::steady_clock::now() + std::chrono::microseconds(random_bits(1, 32 * i + k) % 200);
      while (std::chrono::steady_clock::now() < until) {
      }
      ++done;
    });
    --depth;
  });
  CHECK(done == 64 * 32);
  CHECK(within_itself == 0);
}

TEST_CASE("parallel_for: a grain of 0 or beyond all bounds is one that works") {
  std::atomic<size_t> sum{0};
  parallel_for(5, 0, [&](size_t begin, size_t end) { sum += end - begin; });
  CHECK(sum == 5);
  int calls = 0;
  parallel_for(5, SIZE_MAX, [&](size_t begin, size_t end) {
    ++calls;
    CHECK(begin == 0);
    CHECK(end == 5);
  });
  CHECK(calls == 1);
}

TEST_CASE("parallel_reduce: the same bytes for 1 and 8 threads") {
  std::vector<float> v(100'003);
  for (size_t i = 0; i < v.size(); ++i) v[i] = float(random_unit(1, i)) * 1e3f - 7;
  auto sum = [&] {
    return parallel_reduce(
        v.size(), 1000, 0.0f,
        [&](size_t b, size_t e) {
          float s = 0;
          for (size_t i = b; i < e; ++i) s += v[i];
          return s;
        },
        [](float a, float b) { return a + b; });
  };
  std::vector<float> results;
  for (const int threads : {1, 2, 3, 8}) {
    const Threads use(threads);
    for (int k = 0; k < 5; ++k) results.push_back(sum());
  }
  for (const float r : results) CHECK(std::memcmp(&r, &results[0], 4) == 0);
  CHECK(results[0] == doctest::Approx(493 * 100'003.0).epsilon(0.01));
  CHECK(parallel_reduce(
            0, 10, 42, [](size_t, size_t) { return 1; }, [](int a, int b) { return a + b; }) == 42);
  const std::string order = parallel_reduce(
      26, 1, std::string("<"), [](size_t b, size_t) { return std::string(1, char('a' + b)); },
      [](std::string a, const std::string& b) { return a + b; });
  CHECK(order == "<abcdefghijklmnopqrstuvwxyz");
}

TEST_CASE("parallel_for: an exception of a chunk comes out, cancelling stops the rest") {
  for (const int threads : {1, 4}) {
    const Threads use(threads);
    CHECK(test::error_of([] {
            parallel_for(100, 1, [](size_t begin, size_t) {
              if (begin == 50) fail_data("chunk 50");
            });
          }) == "chunk 50");
    Context context;
    std::atomic<int> ran{0};
    const auto work = [&] {
      parallel_for(
          10'000, 1,
          [&](size_t, size_t) {
            ++ran;
            context.cancel();
          },
          &context);
    };
    CHECK(test::error_of(work) == "cancelled");
    CHECK(ran < 10'000);
  }
}

TEST_CASE("parallel_for: of several exceptions the lowest chunk's comes out, on any number of threads") {
  for (const int threads : {1, 2, 4, 8}) {
    const Threads use(threads);
    for (int again = 0; again < 20; ++again) {
      std::atomic<int> before{0};
      CHECK(test::error_of([&] {
              parallel_for(200, 1, [&](size_t begin, size_t) {
                if (begin < 30) ++before;
                if (begin == 30) std::this_thread::yield();
                if (begin >= 30) fail_data(fmt::format("chunk {}", begin));
              });
            }) == "chunk 30");
      CHECK(before == 30);
    }
  }
}

TEST_CASE("parallel_invoke: both run, and loops nest") {
  std::atomic<int> a{0}, b{0};
  parallel_invoke([&] { parallel_for(100, 10, [&](size_t begin, size_t end) { a += int(end - begin); }); }, [&] { b = 7; });
  CHECK(a == 100);
  CHECK(b == 7);
}

TEST_CASE("exclusive_scan: sums of those before, and the total") {
  std::vector<size_t> v{3, 0, 5, 1};
  CHECK(exclusive_scan(v) == 9);
  CHECK(v == std::vector<size_t>{0, 3, 3, 8});
  std::vector<size_t> none;
  CHECK(exclusive_scan(none) == 0);
}
