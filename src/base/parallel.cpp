// SPDX-License-Identifier: Apache-2.0
#include "base/parallel.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <thread>

#include "base/context.h"
#include "base/serial.h"

#ifdef SG_PLAIN_THREADS  // ThreadSanitizer cannot see into an uninstrumented TBB
#include <atomic>
#include <exception>
#else
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#endif

namespace sg {

namespace {
int wanted_threads = 0;

int all_cores() { return int(std::max(1u, std::thread::hardware_concurrency())); }
}  // namespace

void run_serially() noexcept { wanted_threads = 1; }
int thread_count() { return wanted_threads > 0 ? wanted_threads : all_cores(); }

#ifdef SG_PLAIN_THREADS

void set_thread_count(int n) { wanted_threads = n; }

void detail::run_chunks(size_t chunks, ChunkFn fn, void* body, const Context* context) {
  std::atomic<size_t> next{0};
  std::exception_ptr error;
  std::mutex error_mutex;
  auto work = [&] {
    try {
      for (size_t i; (i = next.fetch_add(1)) < chunks;) {
        if (context) context->check();
        fn(body, i);
      }
    } catch (...) {
      std::lock_guard lock(error_mutex);
      if (!error) error = std::current_exception();
      next = chunks;
    }
  };
  std::vector<std::thread> threads;
  for (size_t i = 1; i < std::min<size_t>(size_t(thread_count()), chunks); ++i) threads.emplace_back(work);
  work();
  for (std::thread& t : threads) t.join();
  if (error) std::rethrow_exception(error);
}

#else

void set_thread_count(int n) {
  static std::mutex mutex;
  static std::unique_ptr<tbb::global_control> limit;
  std::lock_guard lock(mutex);
  wanted_threads = n > 0 ? n : 0;
  limit.reset();
  limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, size_t(thread_count()));
}

void detail::run_chunks(size_t chunks, ChunkFn fn, void* body, const Context* context) {
  if (chunks == 1 || thread_count() == 1) {  // no scheduler start-up for small or serial work
    for (size_t i = 0; i < chunks; ++i) {
      if (context) context->check();
      fn(body, i);
    }
    return;
  }
  // Isolated: who waits for the last chunks of an inner loop must not begin a chunk of an outer one, which may ask for the lock (or the
  // call_once) that the inner loop runs under.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(tbb::blocked_range<size_t>(0, chunks, 1), [&](const tbb::blocked_range<size_t>& r) {
      for (size_t i = r.begin(); i != r.end(); ++i) {
        if (context) context->check();
        fn(body, i);
      }
    });
  });
}

#endif

size_t exclusive_scan(std::vector<size_t>& counts) {
  size_t sum = 0;
  for (size_t& c : counts) {
    const size_t n = c;
    c = sum;
    sum += n;
  }
  return sum;
}

}  // namespace sg
