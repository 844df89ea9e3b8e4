// SPDX-License-Identifier: Apache-2.0
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>

#include "base/context.h"
#include "base/serial.h"

#ifndef SG_PLAIN_THREADS  // ThreadSanitizer cannot see into an uninstrumented TBB
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#endif

namespace sg {

namespace {
int wanted_threads = 0;

int all_cores() { return int(std::max(1u, std::thread::hardware_concurrency())); }

/// Runs chunks, and keeps the exception of the lowest one that throws. Those after it need not run, those before it must: they may throw,
/// too.
class ChunkRunner {
 public:
  ChunkRunner(detail::ChunkFn fn, void* body, const Context* context) : fn_(fn), body_(body), context_(context) {}

  void run(size_t chunk) noexcept {
    if (chunk > failed_.load(std::memory_order_relaxed)) return;
    try {
      if (context_) context_->check();
      fn_(body_, chunk);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (chunk < failed_) failed_ = chunk, error_ = std::current_exception();
    }
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  const detail::ChunkFn fn_;
  void* const body_;
  const Context* const context_;
  std::mutex mutex_;
  std::atomic<size_t> failed_{SIZE_MAX};
  std::exception_ptr error_;
};
}  // namespace

void run_serially() noexcept { wanted_threads = 1; }
int thread_count() { return wanted_threads > 0 ? wanted_threads : all_cores(); }

#ifdef SG_PLAIN_THREADS

void set_thread_count(int n) { wanted_threads = n; }

void detail::run_chunks(size_t chunks, ChunkFn fn, void* body, const Context* context) {
  std::atomic<size_t> next{0};
  ChunkRunner runner(fn, body, context);
  auto work = [&] {
    for (size_t i; (i = next.fetch_add(1)) < chunks;) runner.run(i);
  };
  std::vector<std::thread> threads;
  for (size_t i = 1; i < std::min<size_t>(size_t(thread_count()), chunks); ++i) threads.emplace_back(work);
  work();
  for (std::thread& t : threads) t.join();
  runner.rethrow();
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
  ChunkRunner runner(fn, body, context);
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(tbb::blocked_range<size_t>(0, chunks, 1), [&](const tbb::blocked_range<size_t>& r) {
      for (size_t i = r.begin(); i != r.end(); ++i) runner.run(i);
    });
  });
  runner.rethrow();
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
